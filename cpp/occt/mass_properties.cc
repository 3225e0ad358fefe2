#include "occt/mass_properties.h"

#include <BRepGProp.hxx>
#include <GProp_GProps.hxx>
#include <TopExp_Explorer.hxx>

#include <stdexcept>

#include "softfold-kernel/src/bridge/occt.rs.h"

namespace softfold::occt {
namespace {

constexpr double volume_accuracy = 1e-6;  // asked of the integration, which does a thousand times better
constexpr double worst_accuracy = 1e-4;   // of what it reports, which is cautious

// Gauss-Kronrod, without inertia, which takes as long again. On solids with B-spline faces the plain integration is off by up to 4e-3 and reports 1e-9.
GProp_GProps volume_of(const TopoDS_Shape& shape) {
  GProp_GProps volume;
  const double error = BRepGProp::VolumePropertiesGK(shape, volume, volume_accuracy, Standard_True, Standard_True,
                                                     Standard_True, Standard_False);
  if (!(error >= 0.0 && error < worst_accuracy)) throw std::runtime_error("the volume does not converge");
  return volume;
}

}  // namespace

Mass mass_properties(const TopoDS_Shape& shape) {
  if (!TopExp_Explorer(shape, TopAbs_SOLID).More()) throw std::invalid_argument("the shape has no solid");
  const GProp_GProps volume = volume_of(shape);
  const gp_Pnt center = volume.CentreOfMass();
  return Mass{volume.Mass(), {center.X(), center.Y(), center.Z()}};
}

}  // namespace softfold::occt
