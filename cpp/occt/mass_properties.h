// Volume and center of a solid of density 1, to about this share of themselves.
#pragma once

#include <TopoDS_Shape.hxx>

namespace softfold::occt {
struct Mass;
struct Inertia;
Mass mass_properties(const TopoDS_Shape& shape, double relative);
// With the moments of inertia about the center.
Inertia inertia(const TopoDS_Shape& shape, double relative);
}  // namespace softfold::occt
