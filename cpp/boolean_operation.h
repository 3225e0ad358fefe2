// The numbers that crates/kernel/src/buffers.rs gives to boolean operations.
#pragma once

#include <cstdint>

namespace softfold {
enum class BooleanOperation : std::uint8_t { Union = 0, Intersection = 1, Difference = 2 };
}
