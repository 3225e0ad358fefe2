#include "occt/extruded_polygon.h"

#include <BRepBuilderAPI_MakeFace.hxx>
#include <BRepBuilderAPI_MakePolygon.hxx>
#include <BRepPrimAPI_MakePrism.hxx>
#include <TopoDS_Face.hxx>
#include <TopoDS_Wire.hxx>
#include <gp_Pln.hxx>
#include <gp_Vec.hxx>

#include <stdexcept>

namespace softfold::occt {
namespace {

TopoDS_Wire closed_wire(Numbers outline, double z) {
  BRepBuilderAPI_MakePolygon polygon;
  for (std::size_t i = 0; i + 1 < outline.size(); i += 2) polygon.Add(gp_Pnt(outline[i], outline[i + 1], z));
  polygon.Close();
  if (!polygon.IsDone()) throw std::runtime_error("no wire from the polygon");
  return polygon.Wire();
}

}  // namespace

ShapePtr extruded_polygon(Numbers outline, double z0, double z1) {
  const gp_Pln plane(gp_Pnt(0.0, 0.0, z0), gp_Dir(0.0, 0.0, 1.0));
  BRepBuilderAPI_MakeFace face(plane, closed_wire(outline, z0), Standard_True);
  if (!face.IsDone()) throw std::runtime_error("no face from the polygon");
  require_valid(face.Face(), "the polygon");
  return wrap(outward(BRepPrimAPI_MakePrism(face.Face(), gp_Vec(0.0, 0.0, z1 - z0)).Shape()));
}

}  // namespace softfold::occt
