// How exactly a shape fits together.
#pragma once

#include <TopoDS_Shape.hxx>

namespace softfold::occt {

double largest_tolerance(const TopoDS_Shape& shape);

}  // namespace softfold::occt
