#include "occt/shape.h"

#include <BRepLib.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Solid.hxx>

#include <stdexcept>

#include "occt/faults.h"

namespace softfold::occt {

ShapePtr wrap(const TopoDS_Shape& shape) {
  if (shape.IsNull()) throw std::runtime_error("the result is empty");
  return std::make_unique<TopoDS_Shape>(shape);
}

TopoDS_Shape outward(const TopoDS_Shape& shape) {
  if (shape.IsNull() || shape.ShapeType() != TopAbs_SOLID) return shape;
  TopoDS_Solid solid = TopoDS::Solid(shape);
  if (!BRepLib::OrientClosedSolid(solid)) throw std::runtime_error("the solid is not closed");
  return solid;
}

void require_valid(const TopoDS_Shape& shape, const std::string& name) {
  std::string text;
  for (const std::string& fault : faults(shape)) text += (text.empty() ? "" : "; ") + fault;
  if (!text.empty()) throw std::runtime_error(name + " is not valid: " + text);
}

}  // namespace softfold::occt
