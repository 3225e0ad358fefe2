// The closed solid between an open mesh and its translate.
#pragma once

#include <array>

#include "arrays.h"

namespace softfold {
struct FlatMesh;
}

namespace softfold::cgal {
FlatMesh extrude(Numbers positions, Indices triangles, std::array<double, 3> vector);
}
