// Flat arrays between Rust and C++.
#pragma once

#include <cstddef>
#include <cstdint>

#include "rust/cxx.h"

namespace softfold {

using Numbers = rust::Slice<const double>;
using Indices = rust::Slice<const std::uint32_t>;

template <typename T, typename... Values>
void append(rust::Vec<T>& array, Values... values) {
  (array.push_back(static_cast<T>(values)), ...);
}

}  // namespace softfold
