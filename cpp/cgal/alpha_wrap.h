// A closed mesh around any triangles.
#pragma once

#include "arrays.h"

namespace softfold {
struct FlatMesh;
}

namespace softfold::cgal {
FlatMesh alpha_wrap(Numbers positions, Indices triangles, double alpha, double offset);
}
