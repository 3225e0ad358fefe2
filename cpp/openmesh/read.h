// Reads a PLY, OBJ, STL or OFF file.
#pragma once

#include "rust/cxx.h"

namespace softfold {
struct FlatMesh;
}

namespace softfold::openmesh {
FlatMesh read(rust::Str path);
}
