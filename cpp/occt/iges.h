// IGES files of named and coloured parts, in millimetres.
#pragma once

#include "occt/shape.h"
#include "rust/cxx.h"

namespace softfold::occt {
struct StepHeader;
struct StepPart;
// Solids as solids (186), not as loose trimmed surfaces. The header's schema says nothing here.
void write_iges(rust::Str path, const rust::Vec<StepPart>& parts, const StepHeader& header);
rust::Vec<StepPart> read_iges(rust::Str path);
}  // namespace softfold::occt
