// Points of a surface: x y z for every u v.
#pragma once

#include "arrays.h"

namespace softfold::occt {
struct FlatSurface;
rust::Vec<double> surface_at(const FlatSurface& surface, Numbers uv);
}  // namespace softfold::occt
