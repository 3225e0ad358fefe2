// Parts with names and colours into a STEP file in millimetres. The caller holds the STEP lock.
#pragma once

#include "rust/cxx.h"

namespace softfold::occt {
struct StepHeader;
struct StepPart;
void write_step(rust::Str path, const rust::Vec<StepPart>& parts, const StepHeader& header);
}  // namespace softfold::occt
