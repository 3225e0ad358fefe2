// A shape turned by a rotation (rows), then moved.
#pragma once

#include <array>

#include "occt/shape.h"

namespace softfold::occt {
ShapePtr transformed(const TopoDS_Shape& shape, std::array<double, 9> rotation, std::array<double, 3> translation);
}
