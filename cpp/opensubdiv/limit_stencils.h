// Weights of limit points and their derivatives. `quads` must not descend: one location array per quad.
#pragma once

#include "arrays.h"

namespace softfold::opensubdiv {
struct FlatStencils;
FlatStencils limit_stencils(std::uint32_t vertex_count, Indices cage, Indices quads, Numbers st);
}  // namespace softfold::opensubdiv
