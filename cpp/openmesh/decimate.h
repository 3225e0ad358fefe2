// Fewer triangles within a distance of the input's vertices.
#pragma once

#include "arrays.h"

namespace softfold {
struct FlatMesh;
}

namespace softfold::openmesh {
FlatMesh decimate(Numbers positions, Indices triangles, double max_error);
}
