#include "occt/prism.h"

#include <BRepGProp.hxx>
#include <BRepPrimAPI_MakePrism.hxx>
#include <GProp_GProps.hxx>
#include <gp_Vec.hxx>

#include <cmath>
#include <stdexcept>

namespace softfold::occt {
namespace {

// Of area times length: far above rounding, far below any sheet that is not swept within itself.
constexpr double flattest = 1e-9;

void require_volume(const TopoDS_Shape& solid, const TopoDS_Shape& face, double length) {
  GProp_GProps volume, area;
  BRepGProp::VolumeProperties(solid, volume);
  BRepGProp::SurfaceProperties(face, area);
  if (std::abs(volume.Mass()) <= flattest * area.Mass() * length)
    throw std::runtime_error("the face is swept within itself: the solid has no volume");
}

}  // namespace

ShapePtr prism(const TopoDS_Shape& shape, std::array<double, 3> vector) {
  const gp_Vec sweep(vector[0], vector[1], vector[2]);
  const TopoDS_Shape swept = BRepPrimAPI_MakePrism(shape, sweep).Shape();
  if (shape.ShapeType() == TopAbs_FACE) require_volume(swept, shape, sweep.Magnitude());
  return wrap(outward(swept));
}

}  // namespace softfold::occt
