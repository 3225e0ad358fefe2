// A shape swept along a vector.
#pragma once

#include <array>

#include "occt/shape.h"

namespace softfold::occt {
ShapePtr prism(const TopoDS_Shape& shape, std::array<double, 3> vector);
}
