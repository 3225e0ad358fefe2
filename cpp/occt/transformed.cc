#include "occt/transformed.h"

#include <BRepBuilderAPI_Transform.hxx>
#include <gp_Trsf.hxx>

namespace softfold::occt {

ShapePtr transformed(const TopoDS_Shape& shape, std::array<double, 9> r, std::array<double, 3> t) {
  gp_Trsf motion;
  motion.SetValues(r[0], r[1], r[2], t[0], r[3], r[4], r[5], t[1], r[6], r[7], r[8], t[2]);
  return wrap(BRepBuilderAPI_Transform(shape, motion, Standard_True).Shape());
}

}  // namespace softfold::occt
