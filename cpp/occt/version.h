// The version of OpenCascade's headers and libraries.
#pragma once

#include "rust/cxx.h"

namespace softfold::occt {
rust::String version();
}
