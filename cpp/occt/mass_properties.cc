#include "occt/mass_properties.h"

#include <BRepGProp.hxx>
#include <GProp_GProps.hxx>
#include <TopExp_Explorer.hxx>
#include <gp_Mat.hxx>

#include <stdexcept>

#include "softfold-kernel/src/bridge/occt.rs.h"

namespace softfold::occt {
namespace {

constexpr double volume_accuracy = 1e-6;  // asked of the integration, which does a thousand times better
constexpr double worst_accuracy = 1e-4;   // of what it reports, which is cautious

// Gauss-Kronrod. On solids with B-spline faces the plain integration is off by up to 4e-3 and reports 1e-9.
GProp_GProps volume_of(const TopoDS_Shape& shape) {
  GProp_GProps volume;
  const double error = BRepGProp::VolumePropertiesGK(shape, volume, volume_accuracy, Standard_True, Standard_True,
                                                     Standard_True, Standard_True);
  if (!(error >= 0.0 && error < worst_accuracy)) throw std::runtime_error("the volume does not converge");
  return volume;
}

}  // namespace

Mass mass_properties(const TopoDS_Shape& shape) {
  if (!TopExp_Explorer(shape, TopAbs_SOLID).More()) throw std::invalid_argument("the shape has no solid");
  const GProp_GProps volume = volume_of(shape);
  const gp_Pnt center = volume.CentreOfMass();
  const gp_Mat inertia = volume.MatrixOfInertia();
  Mass mass{volume.Mass(), {center.X(), center.Y(), center.Z()}, {}};
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 3; ++column) mass.inertia[3 * row + column] = inertia(row + 1, column + 1);
  return mass;
}

}  // namespace softfold::occt
