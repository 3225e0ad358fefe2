// Hermite interpolation of degree 5: local, and exactly as smooth as a curve over a bicubic surface is where it crosses
// the surface's knots. OpenCascade's own approximation (degree up to 14, C1) takes about four times as many poles.
#include "occt/edge_curve.h"

#include <TColStd_Array1OfInteger.hxx>
#include <TColStd_Array1OfReal.hxx>
#include <TColgp_Array1OfPnt.hxx>
#include <gp_Vec.hxx>
#include <gp_Vec2d.hxx>

#include <algorithm>
#include <array>

namespace softfold::occt {
namespace {

constexpr int degree = 5;
constexpr int inner_multiplicity = 3;  // leaves C2
// Pieces of the trim curve in each of which a coordinate crosses a knot once, or the tolerance halves a span.
constexpr int pieces = 64;
constexpr int bisections = 60;
// Crossings nearer than this part of the curve are one.
constexpr double same_crossing = 1e-7;
// Places at which a span is compared with its curve: per crossing in it, and at least.
constexpr int checks_per_crossing = 3, fewest_checks = 8;
// A span may be halved this often beyond the crossings.
constexpr int most_halvings = 12;

struct Jet {
  gp_XYZ place, first, second;
};

Jet jet(const Geom_BSplineSurface& surface, const Geom2d_Curve& curve, double t) {
  gp_Pnt2d uv;
  gp_Vec2d d, dd;
  curve.D2(t, uv, d, dd);
  gp_Pnt p;
  gp_Vec u, v, uu, vv, uv2;
  surface.D2(uv.X(), uv.Y(), p, u, v, uu, vv, uv2);
  return {p.XYZ(), u.XYZ() * d.X() + v.XYZ() * d.Y(),
          uu.XYZ() * (d.X() * d.X()) + uv2.XYZ() * (2.0 * d.X() * d.Y()) + vv.XYZ() * (d.Y() * d.Y()) +
              u.XYZ() * dd.X() + v.XYZ() * dd.Y()};
}

using Bezier = std::array<gp_XYZ, degree + 1>;

Bezier bezier(const Jet& a, const Jet& b, double h) {
  return {a.place,
          a.place + a.first * (h / 5.0),
          a.place + a.first * (2.0 * h / 5.0) + a.second * (h * h / 20.0),
          b.place - b.first * (2.0 * h / 5.0) + b.second * (h * h / 20.0),
          b.place - b.first * (h / 5.0),
          b.place};
}

gp_XYZ value(Bezier poles, double s) {
  for (int level = degree; level > 0; --level)
    for (int i = 0; i < level; ++i) poles[i] = poles[i] * (1.0 - s) + poles[i + 1] * s;
  return poles[0];
}

bool keeps(const Geom_BSplineSurface& surface, const Geom2d_Curve& curve, double a, double b, int checks,
           double tolerance) {
  const Bezier poles = bezier(jet(surface, curve, a), jet(surface, curve, b), b - a);
  for (int i = 0; i < checks; ++i) {
    const double s = (i + 0.5) / checks;
    const gp_Pnt2d uv = curve.Value(a + s * (b - a));
    if ((value(poles, s) - surface.Value(uv.X(), uv.Y()).XYZ()).Modulus() > tolerance) return false;
  }
  return true;
}

// Adds where one coordinate of the curve meets the knots, between two parameters.
void add_crossings(const Geom2d_Curve& curve, int axis, const TColStd_Array1OfReal& knots, double a, double b,
                   std::vector<double>& crossings) {
  const auto coordinate = [&](double t) { return curve.Value(t).Coord(axis); };
  const double from = coordinate(a), to = coordinate(b);
  for (const double knot : knots) {
    if ((from - knot) * (to - knot) >= 0.0) continue;
    double low = a, high = b;
    for (int i = 0; i < bisections; ++i) {
      const double middle = 0.5 * (low + high);
      ((coordinate(middle) - knot) * (from - knot) > 0.0 ? low : high) = middle;
    }
    crossings.push_back(0.5 * (low + high));
  }
}

std::vector<double> crossings(const Surfaces& surfaces, const Geom2d_Curve& curve, double first, double last) {
  std::vector<double> found;
  for (const auto& surface : surfaces)
    for (int i = 0; i < pieces; ++i) {
      const double a = first + (last - first) * i / pieces, b = first + (last - first) * (i + 1) / pieces;
      add_crossings(curve, 1, surface->UKnots(), a, b, found);
      add_crossings(curve, 2, surface->VKnots(), a, b, found);
    }
  found.push_back(first);
  std::sort(found.begin(), found.end());
  const double gap = same_crossing * (last - first);
  found.erase(std::unique(found.begin(), found.end(), [gap](double a, double b) { return b - a < gap; }), found.end());
  while (found.size() > 1 && last - found.back() < gap) found.pop_back();
  found.push_back(last);
  return found;
}

// Spans over as many crossings as the tolerance lets, halved where it does not let even one.
class Spans {
public:
  Spans(const Surfaces& surfaces, const Geom2d_Curve& curve, double tolerance)
      : surfaces(surfaces), curve(curve), tolerance(tolerance) {}

  std::vector<double> over(const std::vector<double>& crossings) {
    knots.assign(1, crossings.front());
    for (std::size_t i = 0; i + 1 < crossings.size();) {
      std::size_t next = i + 1;
      while (next + 1 < crossings.size() && keep(crossings[i], crossings[next + 1], static_cast<int>(next + 1 - i))) ++next;
      if (!add(crossings[i], crossings[next], static_cast<int>(next - i), most_halvings)) return {};
      i = next;
    }
    return knots;
  }

private:
  bool keep(double a, double b, int crossed) const {
    const int checks = std::max(fewest_checks, checks_per_crossing * crossed);
    return std::all_of(surfaces.begin(), surfaces.end(),
                       [&](const auto& surface) { return keeps(*surface, curve, a, b, checks, tolerance); });
  }

  bool add(double a, double b, int crossed, int halvings) {
    if (keep(a, b, crossed)) {
      knots.push_back(b);
      return true;
    }
    const double middle = 0.5 * (a + b);
    return halvings > 0 && add(a, middle, crossed, halvings - 1) && add(middle, b, crossed, halvings - 1);
  }

  const Surfaces& surfaces;
  const Geom2d_Curve& curve;
  double tolerance;
  std::vector<double> knots;
};

}  // namespace

std::vector<double> edge_knots(const Surfaces& surfaces, const Handle(Geom2d_Curve) & curve, double first, double last,
                               double tolerance) {
  return Spans(surfaces, *curve, tolerance).over(crossings(surfaces, *curve, first, last));
}

Handle(Geom_BSplineCurve) edge_curve(const Handle(Geom_BSplineSurface) & surface, const Handle(Geom2d_Curve) & curve,
                                     const std::vector<double>& knots) {
  const int spans = static_cast<int>(knots.size()) - 1;
  TColgp_Array1OfPnt poles(1, inner_multiplicity * (spans + 1));
  TColStd_Array1OfReal distinct(1, spans + 1);
  TColStd_Array1OfInteger multiplicities(1, spans + 1);
  multiplicities.Init(inner_multiplicity);
  multiplicities(1) = multiplicities(spans + 1) = degree + 1;
  int pole = 0;
  Jet from = jet(*surface, *curve, knots.front());
  for (int i = 0; i < spans; ++i) {
    const double a = knots[i], b = knots[i + 1];
    const Jet to = jet(*surface, *curve, b);
    const Bezier span = bezier(from, to, b - a);
    if (i == 0) poles(++pole) = span[0], poles(++pole) = span[1];
    poles(++pole) = span[2];
    poles(++pole) = span[3];
    if (i + 1 == spans)
      poles(++pole) = span[4], poles(++pole) = span[5];
    else  // on the line through the two poles before, by C2
      poles(++pole) = span[4] + (span[4] - span[3]) * ((knots[i + 2] - b) / (b - a));
    distinct(i + 1) = a;
    from = to;
  }
  distinct(spans + 1) = knots.back();
  return new Geom_BSplineCurve(poles, distinct, multiplicities, degree);
}

}  // namespace softfold::occt
