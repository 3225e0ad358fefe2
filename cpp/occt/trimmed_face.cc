#include "occt/trimmed_face.h"

#include <BRepBuilderAPI_MakeEdge.hxx>
#include <BRepBuilderAPI_MakeFace.hxx>
#include <BRepLib.hxx>
#include <BRep_Builder.hxx>
#include <Geom2d_BezierCurve.hxx>
#include <Geom2d_Line.hxx>
#include <Precision.hxx>
#include <TColgp_Array1OfPnt2d.hxx>
#include <TopoDS_Wire.hxx>
#include <gp_Dir2d.hxx>
#include <gp_Pnt2d.hxx>
#include <gp_Vec2d.hxx>

#include <stdexcept>
#include <string>

#include "occt/bspline.h"
#include "softfold-kernel/src/bridge/occt.rs.h"

namespace softfold::occt {
namespace {

// How far a 3D curve may leave the surface: well below what any mill or printer resolves.
constexpr double curve_tolerance = 1e-6;

struct TrimCurve {
  Handle(Geom2d_Curve) curve;
  double first, last;
  gp_Pnt2d begin;
};

// A straight curve must be a line, not a Bezier of degree 1: only then are isoparametric edges exact in 3D.
TrimCurve line(const gp_Pnt2d& a, const gp_Pnt2d& b) {
  return {new Geom2d_Line(a, gp_Dir2d(gp_Vec2d(a, b))), 0.0, a.Distance(b), a};
}

TrimCurve trim_curve(const double* uv, std::uint32_t count) {
  if (count == 2) return line({uv[0], uv[1]}, {uv[2], uv[3]});
  TColgp_Array1OfPnt2d poles(1, static_cast<int>(count));
  for (std::uint32_t i = 0; i < count; ++i) poles(static_cast<int>(i) + 1) = gp_Pnt2d(uv[2 * i], uv[2 * i + 1]);
  return {new Geom2d_BezierCurve(poles), 0.0, 1.0, poles.First()};
}

std::vector<std::vector<TrimCurve>> trim_loops(const FlatLoops& flat) {
  std::vector<std::vector<TrimCurve>> loops;
  const double* uv = flat.poles.data();
  auto size = flat.curve_sizes.begin();
  for (const std::uint32_t curves : flat.loop_sizes) {
    auto& loop = loops.emplace_back();
    for (std::uint32_t i = 0; i < curves; ++i, uv += 2 * *size, ++size) loop.push_back(trim_curve(uv, *size));
  }
  return loops;
}

TopoDS_Vertex vertex_at(const Handle(Geom_Surface) & surface, const gp_Pnt2d& uv) {
  TopoDS_Vertex vertex;
  BRep_Builder().MakeVertex(vertex, surface->Value(uv.X(), uv.Y()), Precision::Confusion());
  return vertex;
}

TrimLoop make_loop(const Handle(Geom_Surface) & surface, const std::vector<TrimCurve>& curves) {
  TrimLoop loop;
  for (const TrimCurve& curve : curves) loop.corners.push_back(vertex_at(surface, curve.begin));
  for (std::size_t i = 0; i < curves.size(); ++i) {
    const TrimCurve& c = curves[i];
    const TopoDS_Vertex& end = loop.corners[(i + 1) % curves.size()];
    BRepBuilderAPI_MakeEdge edge(c.curve, surface, loop.corners[i], end, c.first, c.last);
    if (!edge.IsDone()) throw std::runtime_error("no edge from trim curve " + std::to_string(i));
    loop.edges.push_back(edge.Edge());
    if (!BRepLib::BuildCurve3d(loop.edges.back(), curve_tolerance))
      throw std::runtime_error("no 3D curve from trim curve " + std::to_string(i));
  }
  return loop;
}

TopoDS_Wire wire_of(const TrimLoop& loop) {
  BRep_Builder builder;
  TopoDS_Wire wire;
  builder.MakeWire(wire);
  for (const TopoDS_Edge& edge : loop.edges) builder.Add(wire, edge);
  wire.Closed(Standard_True);
  return wire;
}

}  // namespace

TrimmedFace make_trimmed_face(const Handle(Geom_Surface) & surface, const FlatLoops& flat) {
  TrimmedFace made;
  BRep_Builder builder;
  builder.MakeFace(made.face, surface, Precision::Confusion());
  for (const auto& curves : trim_loops(flat)) {
    made.loops.push_back(make_loop(surface, curves));
    builder.Add(made.face, wire_of(made.loops.back()));
  }
  BRepLib::SameParameter(made.face, curve_tolerance);
  require_valid(made.face, "the trimmed face");
  return made;
}

ShapePtr trimmed_face(const FlatSurface& surface, const FlatLoops& loops) {
  return wrap(make_trimmed_face(clamped_surface(surface), loops).face);
}

}  // namespace softfold::occt
