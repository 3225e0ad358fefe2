#include "occt/trim_curve.h"

#include <Geom2d_BezierCurve.hxx>
#include <Geom2d_Line.hxx>
#include <TColgp_Array1OfPnt2d.hxx>
#include <gp_Dir2d.hxx>
#include <gp_Vec2d.hxx>

namespace softfold::occt {
namespace {

// A straight curve must be a line, not a Bezier of degree 1: only then are isoparametric edges exact in 3D.
TrimCurve line(const gp_Pnt2d& a, const gp_Pnt2d& b) {
  const bool isoparametric = a.X() == b.X() || a.Y() == b.Y();
  return {new Geom2d_Line(a, gp_Dir2d(gp_Vec2d(a, b))), 0.0, a.Distance(b), a, b, isoparametric};
}

}  // namespace

TrimCurve trim_curve(const double* uv, std::uint32_t count) {
  if (count == 2) return line({uv[0], uv[1]}, {uv[2], uv[3]});
  TColgp_Array1OfPnt2d poles(1, static_cast<int>(count));
  for (std::uint32_t i = 0; i < count; ++i) poles(static_cast<int>(i) + 1) = gp_Pnt2d(uv[2 * i], uv[2 * i + 1]);
  return {new Geom2d_BezierCurve(poles), 0.0, 1.0, poles.First(), poles.Last(), false};
}

}  // namespace softfold::occt
