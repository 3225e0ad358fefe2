// 3D curves of edges that are given in the parameters of a surface, in few poles.
#pragma once

#include <Geom2d_Curve.hxx>
#include <Geom_BSplineCurve.hxx>
#include <Geom_BSplineSurface.hxx>

#include <vector>

namespace softfold::occt {

using Surfaces = std::vector<Handle(Geom_BSplineSurface)>;

// Parameters of `curve`, from first to last, between which `edge_curve` keeps `tolerance` on each of the surfaces; empty
// if no knots do.
std::vector<double> edge_knots(const Surfaces& surfaces, const Handle(Geom2d_Curve) & curve, double first, double last,
                               double tolerance);

// The curve over the surface as a spline of degree 5, C2, that has its place and two derivatives at the knots, with the
// same parameters.
Handle(Geom_BSplineCurve) edge_curve(const Handle(Geom_BSplineSurface) & surface, const Handle(Geom2d_Curve) & curve,
                                     const std::vector<double>& knots);

}  // namespace softfold::occt
