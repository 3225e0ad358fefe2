// The faults of a shape in words; nothing if it is valid.
#pragma once

#include <TopoDS_Shape.hxx>

#include "rust/cxx.h"

namespace softfold::occt {
rust::Vec<rust::String> check(const TopoDS_Shape& shape);
}
