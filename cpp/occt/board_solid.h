// The solid between two surfaces over the same parameters, trimmed by the same loops.
#pragma once

#include "occt/shape.h"

namespace softfold::occt {
struct FlatLoops;
struct FlatSurface;
ShapePtr board_solid(const FlatSurface& lower, const FlatSurface& upper, const FlatLoops& loops);
}  // namespace softfold::occt
