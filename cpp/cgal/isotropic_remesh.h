// Remeshes towards edges of one length.
#pragma once

#include "arrays.h"

namespace softfold {
struct FlatMesh;
}

namespace softfold::cgal {
FlatMesh isotropic_remesh(Numbers positions, Indices triangles, double target_edge, std::uint32_t iterations);
}
