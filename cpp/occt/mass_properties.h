// Volume and center of a solid of density 1.
#pragma once

#include <TopoDS_Shape.hxx>

namespace softfold::occt {
struct Mass;
Mass mass_properties(const TopoDS_Shape& shape);
}  // namespace softfold::occt
