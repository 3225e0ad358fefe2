// Corners of the convex hull of points (u v each), counter-clockwise.
#pragma once

#include "arrays.h"

namespace softfold::cgal {
rust::Vec<std::uint32_t> convex_hull(Numbers points);
}
