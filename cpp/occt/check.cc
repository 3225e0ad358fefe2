#include "occt/check.h"

#include "occt/faults.h"

namespace softfold::occt {

rust::Vec<rust::String> check(const TopoDS_Shape& shape) {
  rust::Vec<rust::String> list;
  for (const std::string& fault : faults(shape)) list.push_back(rust::String::lossy(fault));
  return list;
}

}  // namespace softfold::occt
