// As ../trycatch.h, for OpenCascade: its Standard_Failure is no std::exception in 7.6.
#pragma once

#include <Standard_Failure.hxx>

#include <exception>
#include <string>

namespace softfold::occt {
inline std::string words(const Standard_Failure& failure) {
  const std::string name = failure.DynamicType()->Name();
  const char* message = failure.GetMessageString();
  return message && *message ? name + ": " + message : name;
}
}  // namespace softfold::occt

namespace rust::behavior {
template <typename Try, typename Fail>
static void trycatch(Try&& call, Fail&& fail) noexcept try {
  call();
} catch (const Standard_Failure& failure) {
  fail(softfold::occt::words(failure));
} catch (const std::exception& error) {
  fail(error.what());
} catch (...) {
  fail("unknown C++ exception");
}
}  // namespace rust::behavior
