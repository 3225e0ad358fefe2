#include "occt/brep_file.h"

#include <BRepTools.hxx>
#include <BRep_Builder.hxx>

#include <stdexcept>
#include <string>

#include "occt/messages.h"

namespace softfold::occt {

void write_brep(rust::Str path, const TopoDS_Shape& shape) {
  take_messages();
  // Version 1, which all readers take; without triangles, which are no part of the shape.
  if (!BRepTools::Write(shape, std::string(path).c_str(), Standard_False, Standard_False, TopTools_FormatVersion_VERSION_1))
    throw std::runtime_error("the file cannot be written: " + take_messages());
}

ShapePtr read_brep(rust::Str path) {
  take_messages();
  TopoDS_Shape shape;
  if (!BRepTools::Read(shape, std::string(path).c_str(), BRep_Builder()) || shape.IsNull())
    throw std::runtime_error("this is no BREP file OpenCascade can read: " + take_messages());
  return wrap(shape);
}

}  // namespace softfold::occt
