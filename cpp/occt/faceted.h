// A mesh as a shell of plane faces.
#pragma once

#include "arrays.h"
#include "occt/shape.h"

namespace softfold::occt {
// One face per triangle, edges and vertices shared; a closed mesh gives a solid.
ShapePtr faceted(Numbers positions, Indices triangles);
}  // namespace softfold::occt
