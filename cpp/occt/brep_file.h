// A shape in OpenCascade's own text format, which has no names, colours or units.
#pragma once

#include "occt/shape.h"
#include "rust/cxx.h"

namespace softfold::occt {
void write_brep(rust::Str path, const TopoDS_Shape& shape);
ShapePtr read_brep(rust::Str path);
}  // namespace softfold::occt
