// Turns what C++ throws into Rust's Err. cxx's own version lets anything but std::exception end the process.
// The generated code uses the version it sees first, so every bridge includes this before anything else.
#pragma once

#include <exception>

namespace rust::behavior {
template <typename Try, typename Fail>
static void trycatch(Try&& call, Fail&& fail) noexcept try {
  call();
} catch (const std::exception& error) {
  fail(error.what());
} catch (...) {
  fail("unknown C++ exception");
}
}  // namespace rust::behavior
