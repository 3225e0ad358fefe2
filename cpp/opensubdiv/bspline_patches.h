// The limit surface as bicubic B-spline patches of 16 control points.
#pragma once

#include "arrays.h"

namespace softfold::opensubdiv {
struct FlatPatches;
// `isolation`: how often a quad at an extraordinary vertex is halved before the rest of it is approximated.
FlatPatches bspline_patches(std::uint32_t vertex_count, Indices cage, std::uint32_t isolation);
}  // namespace softfold::opensubdiv
