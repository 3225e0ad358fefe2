// Whether triangles bound a solid.
#pragma once

#include "arrays.h"

namespace softfold::cgal {
struct Closedness;
Closedness closed_check(Numbers positions, Indices triangles);
}  // namespace softfold::cgal
