// Makes an oriented manifold mesh of any triangles.
#pragma once

#include "arrays.h"

namespace softfold::openmesh {
struct CleanedMesh;
CleanedMesh clean(Numbers positions, Indices triangles, double merge);
}  // namespace softfold::openmesh
