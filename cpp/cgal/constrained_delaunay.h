// Constrained Delaunay triangulation of points (u v each) with constraints (two points each).
// The distinct input points come first, in order, then the crossings in the order the constraints meet them.
#pragma once

#include "arrays.h"

namespace softfold::cgal {
struct FlatTriangulation;
FlatTriangulation constrained_delaunay(Numbers points, Indices constraints);
}  // namespace softfold::cgal
