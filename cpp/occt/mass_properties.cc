#include "occt/mass_properties.h"

#include <BRepBuilderAPI_NurbsConvert.hxx>
#include <BRepGProp.hxx>
#include <GProp_GProps.hxx>
#include <TopExp_Explorer.hxx>
#include <gp_Mat.hxx>

#include <stdexcept>

#include "softfold-kernel/src/bridge/occt.rs.h"

namespace softfold::occt {
namespace {

constexpr double volume_accuracy = 1e-8;  // asked of the integration, which does far better
constexpr double worst_accuracy = 1e-4;   // of what it reports, which is cautious
constexpr double area_accuracy = 1e-9;

// Gauss-Kronrod. On solids with B-spline faces the plain integration is off by up to 4e-3 and reports 1e-9.
GProp_GProps volume_of(const TopoDS_Shape& shape) {
  GProp_GProps volume;
  const double error = BRepGProp::VolumePropertiesGK(shape, volume, volume_accuracy, Standard_True, Standard_True,
                                                     Standard_True, Standard_True);
  if (!(error >= 0.0 && error < worst_accuracy)) throw std::runtime_error("the volume does not converge");
  return volume;
}

// As B-splines: areas of swept surfaces over B-spline curves come out wrong by up to 0.6 %.
GProp_GProps area_of(const TopoDS_Shape& shape) {
  GProp_GProps area;
  BRepGProp::SurfaceProperties(BRepBuilderAPI_NurbsConvert(shape, Standard_True).Shape(), area, area_accuracy);
  return area;
}

}  // namespace

Mass mass_properties(const TopoDS_Shape& shape) {
  const bool solid = TopExp_Explorer(shape, TopAbs_SOLID).More();
  const GProp_GProps area = area_of(shape);
  const GProp_GProps main = solid ? volume_of(shape) : area;
  const gp_Pnt center = main.CentreOfMass();
  const gp_Mat inertia = main.MatrixOfInertia();
  Mass mass{solid ? main.Mass() : 0.0, area.Mass(), {center.X(), center.Y(), center.Z()}, {}};
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 3; ++column) mass.inertia[3 * row + column] = inertia(row + 1, column + 1);
  return mass;
}

}  // namespace softfold::occt
