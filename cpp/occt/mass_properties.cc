#include "occt/mass_properties.h"

#include <BRepGProp.hxx>
#include <GProp_GProps.hxx>
#include <TopExp_Explorer.hxx>
#include <gp_Mat.hxx>

#include <array>
#include <stdexcept>

#include "softfold-kernel/src/bridge/occt.rs.h"

namespace softfold::occt {
namespace {

// What the integration reports may be so many times what was asked of it: on solids with B-spline faces both the report and
// the true error are up to twenty times that.
constexpr double most_reported = 100.0;

// Gauss-Kronrod; inertia takes as long again. On solids with B-spline faces the plain integration is off by up to 4e-3 and
// reports 1e-9.
GProp_GProps volume_of(const TopoDS_Shape& shape, double relative, bool inertia) {
  if (!TopExp_Explorer(shape, TopAbs_SOLID).More()) throw std::invalid_argument("the shape has no solid");
  GProp_GProps volume;
  const double error = BRepGProp::VolumePropertiesGK(shape, volume, relative, Standard_True, Standard_True,
                                                     Standard_True, inertia);
  if (!(error >= 0.0 && error < most_reported * relative)) throw std::runtime_error("the volume does not converge");
  return volume;
}

std::array<double, 3> numbers(const gp_XYZ& v) { return {v.X(), v.Y(), v.Z()}; }

}  // namespace

Mass mass_properties(const TopoDS_Shape& shape, double relative) {
  const GProp_GProps volume = volume_of(shape, relative, false);
  return Mass{volume.Mass(), numbers(volume.CentreOfMass().XYZ())};
}

// OpenCascade's matrix is that about the center.
Inertia inertia(const TopoDS_Shape& shape, double relative) {
  const GProp_GProps volume = volume_of(shape, relative, true);
  const gp_Mat matrix = volume.MatrixOfInertia();
  std::array<double, 9> rows;
  for (int i = 0; i < 9; ++i) rows[i] = matrix.Value(i / 3 + 1, i % 3 + 1);
  return Inertia{volume.Mass(), numbers(volume.CentreOfMass().XYZ()), rows};
}

}  // namespace softfold::occt
