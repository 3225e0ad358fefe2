// The limit surface as bicubic B-spline patches of 16 control points.
#pragma once

#include "arrays.h"

namespace softfold::opensubdiv {
struct FlatPatches;
FlatPatches bspline_patches(std::uint32_t vertex_count, Indices cage);
}  // namespace softfold::opensubdiv
