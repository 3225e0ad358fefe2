// Faces share edges and vertices by their numbers, so nothing is sewn by distance. Every edge is a line in the parameters
// of its faces, which all count in the same unit, so that one parameter serves them all.
#include "occt/shell.h"

#include <BRep_Builder.hxx>
#include <BRep_Tool.hxx>
#include <Geom2d_Line.hxx>
#include <Geom_BSplineCurve.hxx>
#include <Geom_BSplineSurface.hxx>
#include <Precision.hxx>
#include <TColStd_Array1OfReal.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Face.hxx>
#include <TopoDS_Shell.hxx>
#include <TopoDS_Wire.hxx>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

#include "occt/bspline.h"
#include "softfold-kernel/src/bridge/occt.rs.h"

namespace softfold::occt {
namespace {

using Surface = Handle(Geom_BSplineSurface);

// Places along an edge where the curves of its faces are compared.
constexpr int gap_samples = 8;
// Tolerance over the gap that was found.
constexpr double gap_factor = 1.5;

// One face's side of an edge: u, v of the edge's start and its direction.
struct Use {
  gp_Pnt2d start;
  gp_Dir2d direction;
};

Use use_at(const FlatShell& flat, std::size_t i) {
  const double* p = flat.use_lines.data() + 4 * i;
  return {gp_Pnt2d(p[0], p[1]), gp_Dir2d(p[2], p[3])};
}

// The isoparametric curve along a line of the surface, over 0 to `length` in the line's direction.
Handle(Geom_BSplineCurve) iso_curve(const Surface& surface, const Use& use, double length) {
  const bool along_u = std::abs(use.direction.X()) > 0.5;
  const double from = along_u ? use.start.X() : use.start.Y();
  const bool rising = (along_u ? use.direction.X() : use.direction.Y()) > 0.0;
  Handle(Geom_Curve) iso = along_u ? surface->VIso(use.start.Y()) : surface->UIso(use.start.X());
  Handle(Geom_BSplineCurve) curve = Handle(Geom_BSplineCurve)::DownCast(iso);
  if (curve.IsNull()) throw std::runtime_error("a side of a face is no B-spline");
  curve->Segment(rising ? from : from - length, rising ? from + length : from);
  if (!rising) curve->Reverse();
  TColStd_Array1OfReal knots(1, curve->NbKnots());
  curve->Knots(knots);
  const double first = knots.First(), scale = length / (knots.Last() - first);
  for (int i = knots.Lower(); i <= knots.Upper(); ++i) knots(i) = (knots(i) - first) * scale;
  curve->SetKnots(knots);
  return curve;
}

double gap(const Geom_Curve& curve, const Surface& surface, const Use& use, double length) {
  double worst = 0.0;
  for (int i = 0; i <= gap_samples; ++i) {
    const double t = length * i / gap_samples;
    const gp_Pnt2d uv = use.start.Translated(t * gp_Vec2d(use.direction));
    worst = std::max(worst, curve.Value(t).Distance(surface->Value(uv.X(), uv.Y())));
  }
  return worst;
}

class Builder {
public:
  explicit Builder(const FlatShell& flat) : flat(flat) {
    for (const FlatSurface& surface : flat.surfaces) surfaces.push_back(clamped_surface(surface));
    for (std::size_t i = 0; i + 2 < flat.vertices.size(); i += 3) {
      vertices.emplace_back();
      const gp_Pnt point(flat.vertices[i], flat.vertices[i + 1], flat.vertices[i + 2]);
      builder.MakeVertex(vertices.back(), point, Precision::Confusion());
    }
  }

  SewnShell build() {
    add_faces();
    TopoDS_Shell shell;
    builder.MakeShell(shell);
    for (const TopoDS_Face& face : faces) builder.Add(shell, face);
    require_valid(shell, "the surface of patches");
    SewnShell made;
    made.shape = wrap(shell);
    made.gap = worst;
    return made;
  }

private:
  // Faces first, bare; then edges with a curve in each; then the wires.
  void add_faces() {
    for (const Surface& surface : surfaces) {
      faces.emplace_back();
      builder.MakeFace(faces.back(), surface, Precision::Confusion());
    }
    for (std::size_t e = 0, use = 0; e < flat.edge_lengths.size(); use += flat.edge_uses[e++]) add_edge(e, use);
    std::size_t side = 0;
    for (std::size_t f = 0; f < faces.size(); ++f) {
      TopoDS_Wire wire;
      builder.MakeWire(wire);
      for (std::uint32_t k = 0; k < flat.border_sizes[f]; ++k, ++side) {
        const TopoDS_Edge& edge = edges[flat.border_edges[side]];
        builder.Add(wire, flat.border_forward[side] ? edge : TopoDS::Edge(edge.Reversed()));
      }
      wire.Closed(Standard_True);
      builder.Add(faces[f], wire);
    }
  }

  void add_edge(std::size_t e, std::size_t first_use) {
    const double length = flat.edge_lengths[e];
    const auto curve = iso_curve(surfaces[flat.use_faces[first_use]], use_at(flat, first_use), length);
    TopoDS_Edge edge;
    builder.MakeEdge(edge, curve, Precision::Confusion());
    double off = 0.0;
    for (std::size_t i = first_use; i < first_use + flat.edge_uses[e]; ++i) {
      const Use use = use_at(flat, i);
      const std::uint32_t face = flat.use_faces[i];
      builder.UpdateEdge(edge, new Geom2d_Line(use.start, use.direction), faces[face], Precision::Confusion());
      off = std::max(off, gap(*curve, surfaces[face], use, length));
    }
    builder.Range(edge, 0.0, length);
    builder.UpdateEdge(edge, std::max(gap_factor * off, Precision::Confusion()));
    for (const int end : {0, 1}) off = std::max(off, add_end(edge, e, end, curve->Value(end * length)));
    builder.SameParameter(edge, Standard_True);
    builder.SameRange(edge, Standard_True);
    worst = std::max(worst, off);
    edges.push_back(edge);
  }

  // Distance of the vertex from the curve's end.
  double add_end(TopoDS_Edge& edge, std::size_t e, int end, const gp_Pnt& at) {
    TopoDS_Vertex& vertex = vertices[flat.edge_vertices[2 * e + end]];
    const double off = BRep_Tool::Pnt(vertex).Distance(at);
    const double needed = gap_factor * std::max(off, BRep_Tool::Tolerance(edge));
    builder.UpdateVertex(vertex, std::max(needed, Precision::Confusion()));
    builder.Add(edge, vertex.Oriented(end == 0 ? TopAbs_FORWARD : TopAbs_REVERSED));
    return off;
  }

  const FlatShell& flat;
  BRep_Builder builder;
  std::vector<Surface> surfaces;
  std::vector<TopoDS_Vertex> vertices;
  std::vector<TopoDS_Face> faces;
  std::vector<TopoDS_Edge> edges;
  double worst = 0.0;
};

}  // namespace

SewnShell shell(const FlatShell& flat) { return Builder(flat).build(); }

}  // namespace softfold::occt
