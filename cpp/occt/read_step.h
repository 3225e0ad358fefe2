// The parts of a STEP file with their names and colours, in place, in millimetres. The caller holds the STEP lock.
#pragma once

#include "rust/cxx.h"

namespace softfold::occt {
struct StepPart;
rust::Vec<StepPart> read_step(rust::Str path);
}  // namespace softfold::occt
