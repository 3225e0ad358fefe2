// Nothing is sewn: faces are made with the vertices and edges that they share.
#include "occt/sheet_shell.h"

#include <BRepBuilderAPI_MakeEdge.hxx>
#include <BRepLib.hxx>
#include <BRepLib_CheckCurveOnSurface.hxx>
#include <BRep_Builder.hxx>
#include <BRep_Tool.hxx>
#include <Geom_BSplineSurface.hxx>
#include <Precision.hxx>
#include <TopoDS_Vertex.hxx>
#include <TopoDS_Wire.hxx>

#include <algorithm>
#include <stdexcept>
#include <string>

#include "occt/bspline.h"
#include "occt/trim_curve.h"
#include "softfold-kernel/src/bridge/occt.rs.h"

namespace softfold::occt {
namespace {

// How far a 3D curve may leave the first face: with what the other face may be off the edge is one to 1e-6 mm.
constexpr double shared_curve_tolerance = 4e-7;
// Tolerances are what was measured and this share, for the places that were not looked at.
constexpr double measured_share = 1.05;

struct EdgeUse {
  std::size_t face, edge;
  bool reversed;
};

struct FlatEdge {
  TrimCurve curve;
  std::size_t start, end;
};

class Builder {
 public:
  Builder(const rust::Vec<FlatSurface>& surfaces, const FlatSheetShell& flat) {
    for (const FlatSurface& surface : surfaces) surfaces_.push_back(clamped_surface(surface));
    read_edges(flat);
    read_loops(flat);
    make_vertices(flat.corner_count);
    make_edges();
    make_faces();
  }

  SheetShell shell() {
    BRep_Builder builder;
    SheetShell made;
    builder.MakeShell(made.shell);
    for (const TopoDS_Face& face : faces_) builder.Add(made.shell, face);
    BRepLib::UpdateTolerances(made.shell);
    made.edges = edges_;
    made.uses.assign(edges_.size(), 0);
    for (const EdgeUse& use : uses_) ++made.uses[use.edge];
    made.shell.Closed(std::find(made.uses.begin(), made.uses.end(), 1) == made.uses.end());
    return made;
  }

 private:
  void read_edges(const FlatSheetShell& flat) {
    const double* uv = flat.poles.data();
    for (std::size_t i = 0; i < flat.edge_sizes.size(); ++i) {
      const std::uint32_t size = flat.edge_sizes[i];
      flat_.push_back({trim_curve(uv, size), flat.edge_corners[2 * i], flat.edge_corners[2 * i + 1]});
      uv += 2 * size;
    }
  }

  void read_loops(const FlatSheetShell& flat) {
    auto size = flat.loop_sizes.begin();
    auto use = flat.uses.begin();
    for (std::size_t face = 0; face < flat.face_sizes.size(); ++face)
      for (std::uint32_t l = 0; l < flat.face_sizes[face]; ++l, ++size) {
        loops_.push_back({face, uses_.size(), uses_.size() + *size});
        for (std::uint32_t i = 0; i < *size; ++i, ++use) uses_.push_back({face, *use / 2, *use % 2 == 1});
      }
  }

  gp_Pnt at(std::size_t face, const gp_Pnt2d& uv) const { return surfaces_[face]->Value(uv.X(), uv.Y()); }

  // In the middle of where the faces that meet have it.
  void make_vertices(std::size_t count) {
    std::vector<std::vector<gp_Pnt>> places(count);
    for (const EdgeUse& use : uses_) {
      const FlatEdge& edge = flat_[use.edge];
      places[edge.start].push_back(at(use.face, edge.curve.begin));
      places[edge.end].push_back(at(use.face, edge.curve.end));
    }
    for (const auto& of_corner : places) vertices_.push_back(vertex(of_corner));
  }

  static TopoDS_Vertex vertex(const std::vector<gp_Pnt>& places) {
    gp_XYZ sum(0.0, 0.0, 0.0);
    for (const gp_Pnt& p : places) sum += p.XYZ();
    const gp_Pnt middle(sum / static_cast<double>(std::max<std::size_t>(places.size(), 1)));
    double off = 0.0;
    for (const gp_Pnt& p : places) off = std::max(off, p.Distance(middle));
    TopoDS_Vertex made;
    BRep_Builder().MakeVertex(made, middle, Precision::Confusion() + measured_share * off);
    return made;
  }

  // The 3D curve is the image on the first face that has the edge; the others' images are measured against it.
  void make_edges() {
    edges_.resize(flat_.size());
    for (const EdgeUse& use : uses_) {
      TopoDS_Edge& edge = edges_[use.edge];
      if (edge.IsNull()) edge = first_edge(use);
      else add_image(edge, use);
    }
  }

  TopoDS_Edge first_edge(const EdgeUse& use) const {
    const FlatEdge& e = flat_[use.edge];
    BRepBuilderAPI_MakeEdge made(e.curve.curve, surfaces_[use.face], vertices_[e.start], vertices_[e.end],
                                 e.curve.first, e.curve.last);
    if (!made.IsDone()) throw std::runtime_error("no edge from curve " + std::to_string(use.edge));
    TopoDS_Edge edge = made.Edge();
    if (!BRepLib::BuildCurve3d(edge, shared_curve_tolerance))
      throw std::runtime_error("no 3D curve from curve " + std::to_string(use.edge));
    return edge;
  }

  void add_image(TopoDS_Edge& edge, const EdgeUse& use) const {
    const FlatEdge& e = flat_[use.edge];
    BRep_Builder().UpdateEdge(edge, e.curve.curve, surfaces_[use.face], TopLoc_Location(), Precision::Confusion());
    BRep_Builder().Range(edge, surfaces_[use.face], TopLoc_Location(), e.curve.first, e.curve.last);
  }

  void make_faces() {
    BRep_Builder builder;
    for (const auto& surface : surfaces_) builder.MakeFace(faces_.emplace_back(), surface, Precision::Confusion());
    for (const Loop& loop : loops_) builder.Add(faces_[loop.face], wire(loop));
    for (const EdgeUse& use : uses_) measure(use);
  }

  struct Loop {
    std::size_t face, first, last;
  };

  TopoDS_Wire wire(const Loop& loop) const {
    BRep_Builder builder;
    TopoDS_Wire wire;
    builder.MakeWire(wire);
    for (std::size_t i = loop.first; i < loop.last; ++i) {
      const TopoDS_Edge& edge = edges_[uses_[i].edge];
      builder.Add(wire, uses_[i].reversed ? edge.Reversed() : TopoDS_Shape(edge));
    }
    wire.Closed(Standard_True);
    return wire;
  }

  void measure(const EdgeUse& use) {
    TopoDS_Edge& edge = edges_[use.edge];
    BRepLib_CheckCurveOnSurface check(edge, faces_[use.face]);
    check.Perform();
    if (!check.IsDone()) throw std::runtime_error("edge " + std::to_string(use.edge) + " cannot be measured");
    BRep_Builder builder;
    builder.UpdateEdge(edge, std::max(BRep_Tool::Tolerance(edge), measured_share * check.MaxDistance()));
    builder.SameRange(edge, Standard_True);
    builder.SameParameter(edge, Standard_True);
  }

  std::vector<Handle(Geom_BSplineSurface)> surfaces_;
  std::vector<FlatEdge> flat_;
  std::vector<EdgeUse> uses_;
  std::vector<Loop> loops_;
  std::vector<TopoDS_Vertex> vertices_;
  std::vector<TopoDS_Edge> edges_;
  std::vector<TopoDS_Face> faces_;
};

}  // namespace

SheetShell make_sheet_shell(const rust::Vec<FlatSurface>& surfaces, const FlatSheetShell& flat) {
  SheetShell made = Builder(surfaces, flat).shell();
  require_valid(made.shell, "the shell of the sheet");
  return made;
}

ShapePtr sheet_shell(const rust::Vec<FlatSurface>& surfaces, const FlatSheetShell& flat) {
  return wrap(make_sheet_shell(surfaces, flat).shell);
}

}  // namespace softfold::occt
