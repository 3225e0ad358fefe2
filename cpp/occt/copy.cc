#include "occt/copy.h"

#include <BRepBuilderAPI_Copy.hxx>

namespace softfold::occt {
ShapePtr copy(const TopoDS_Shape& shape) {
  return wrap(BRepBuilderAPI_Copy(shape, Standard_True, Standard_False).Shape());
}
}  // namespace softfold::occt
