// Union, intersection or difference; `operation` is a softfold::BooleanOperation.
#pragma once

#include <cstdint>

#include "occt/shape.h"

namespace softfold::occt {
ShapePtr boolean(const TopoDS_Shape& a, const TopoDS_Shape& b, std::uint8_t operation);
}
