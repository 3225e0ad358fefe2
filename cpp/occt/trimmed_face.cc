#include "occt/trimmed_face.h"

#include <BRepBuilderAPI_MakeEdge.hxx>
#include <BRepBuilderAPI_MakeFace.hxx>
#include <BRepLib.hxx>
#include <BRep_Builder.hxx>
#include <Precision.hxx>
#include <TopoDS_Wire.hxx>

#include <stdexcept>
#include <string>

#include "occt/bspline.h"
#include "occt/edge_curve.h"
#include "occt/trim_curve.h"
#include "softfold-kernel/src/bridge/occt.rs.h"

namespace softfold::occt {
namespace {

// Our own 3D curves stay within what an edge's tolerance is anyway.
constexpr double own_share = 0.5;

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

// Over an isoparametric line OpenCascade's own curve, which is exact.
void add_curve(const TopoDS_Edge& edge, const TrimCurve& c, const Handle(Geom_BSplineSurface) & surface,
               const Surfaces& partners, std::size_t number) {
  std::vector<double> knots;
  if (!c.isoparametric) knots = edge_knots(partners, c.curve, c.first, c.last, own_share * Precision::Confusion());
  if (knots.empty()) {
    if (!BRepLib::BuildCurve3d(edge, curve_tolerance))
      throw std::runtime_error("no 3D curve from trim curve " + std::to_string(number));
    return;
  }
  BRep_Builder().UpdateEdge(edge, edge_curve(surface, c.curve, knots), Precision::Confusion());
  BRep_Builder().Range(edge, c.first, c.last);
}

TrimLoop make_loop(const Handle(Geom_BSplineSurface) & surface, const std::vector<TrimCurve>& curves,
                   const Surfaces& partners) {
  TrimLoop loop;
  for (const TrimCurve& curve : curves) loop.corners.push_back(vertex_at(surface, curve.begin));
  for (std::size_t i = 0; i < curves.size(); ++i) {
    const TrimCurve& c = curves[i];
    const TopoDS_Vertex& end = loop.corners[(i + 1) % curves.size()];
    BRepBuilderAPI_MakeEdge edge(c.curve, surface, loop.corners[i], end, c.first, c.last);
    if (!edge.IsDone()) throw std::runtime_error("no edge from trim curve " + std::to_string(i));
    loop.edges.push_back(edge.Edge());
    add_curve(loop.edges.back(), c, surface, partners, i);
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

TrimmedFace make_trimmed_face(const Handle(Geom_BSplineSurface) & surface, const FlatLoops& flat,
                              const Surfaces& partners) {
  TrimmedFace made;
  BRep_Builder builder;
  builder.MakeFace(made.face, surface, Precision::Confusion());
  for (const auto& curves : trim_loops(flat)) {
    made.loops.push_back(make_loop(surface, curves, partners));
    builder.Add(made.face, wire_of(made.loops.back()));
  }
  BRepLib::SameParameter(made.face, curve_tolerance);
  require_valid(made.face, "the trimmed face");
  return made;
}

ShapePtr trimmed_face(const FlatSurface& surface, const FlatLoops& loops) {
  const Handle(Geom_BSplineSurface) geometry = clamped_surface(surface);
  return wrap(make_trimmed_face(geometry, loops, {geometry}).face);
}

}  // namespace softfold::occt
