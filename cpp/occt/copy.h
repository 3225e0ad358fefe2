// A copy that shares neither topology, geometry nor triangulation.
#pragma once

#include "occt/shape.h"

namespace softfold::occt {
ShapePtr copy(const TopoDS_Shape& shape);
}
