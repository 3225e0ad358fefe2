#include "occt/version.h"

#include <Standard_Version.hxx>

namespace softfold::occt {
rust::String version() { return OCC_VERSION_COMPLETE; }
}  // namespace softfold::occt
