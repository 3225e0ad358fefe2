// The solid above a polygon, from z0 to z1.
#pragma once

#include "arrays.h"
#include "occt/shape.h"

namespace softfold::occt {
ShapePtr extruded_polygon(Numbers outline, double z0, double z1);
}
