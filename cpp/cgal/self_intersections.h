// Pairs of triangles that intersect, two indices each, sorted.
#pragma once

#include "arrays.h"

namespace softfold::cgal {
rust::Vec<std::uint32_t> self_intersections(Numbers positions, Indices triangles);
}
