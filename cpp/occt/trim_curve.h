// Curves in the parameters of a surface.
#pragma once

#include <Geom2d_Curve.hxx>
#include <gp_Pnt2d.hxx>

#include <cstdint>

namespace softfold::occt {

// How far OpenCascade's 3D curves may leave the surface: well below what any mill or printer resolves.
constexpr double curve_tolerance = 1e-6;

struct TrimCurve {
  Handle(Geom2d_Curve) curve;
  double first, last;
  gp_Pnt2d begin, end;
  // Whether it runs along u or v.
  bool isoparametric;
};

// A Bezier curve by `count` poles (u, v); two make a line.
TrimCurve trim_curve(const double* uv, std::uint32_t count);

}  // namespace softfold::occt
