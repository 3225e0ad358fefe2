// OpenCascade's messages: kept, never printed.
#pragma once

#include <string>

namespace softfold::occt {

// Silences OpenCascade and registers its STEP parameters. Once per process, before anything else.
void start();

// The warnings and failures since the last call, each on its line.
std::string take_messages();

}  // namespace softfold::occt
