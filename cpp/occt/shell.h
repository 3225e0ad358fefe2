// Faces that share edges, from flat arrays.
#pragma once

#include "occt/shape.h"

namespace softfold::occt {

struct FlatShell;
struct SewnShell;

// Edges take the curve of the face that names them first; `gap` is how far those of other faces leave it.
SewnShell shell(const FlatShell& flat);

}  // namespace softfold::occt
