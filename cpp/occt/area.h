// Area of a shape's faces.
#pragma once

#include <TopoDS_Shape.hxx>

namespace softfold::occt {
double area(const TopoDS_Shape& shape);
}  // namespace softfold::occt
