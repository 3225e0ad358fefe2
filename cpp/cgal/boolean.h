// Union, intersection or difference of two closed meshes; `operation` is a softfold::BooleanOperation.
#pragma once

#include "arrays.h"

namespace softfold {
struct FlatMesh;
}

namespace softfold::cgal {
FlatMesh boolean(Numbers a_positions, Indices a_triangles, Numbers b_positions, Indices b_triangles,
                 std::uint8_t operation);
}
