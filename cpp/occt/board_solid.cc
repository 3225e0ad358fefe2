// The side faces take over the edges of both trimmed faces and share their posts with their neighbours, so that the
// shell is closed by construction and nothing is sewn.
#include "occt/board_solid.h"

#include <BRepBuilderAPI_MakeEdge.hxx>
#include <BRepTools.hxx>
#include <BRepTopAdaptor_FClass2d.hxx>
#include <BRep_Builder.hxx>
#include <BRep_Tool.hxx>
#include <Geom2d_Line.hxx>
#include <GeomFill.hxx>
#include <Geom_BSplineCurve.hxx>
#include <Geom_BSplineSurface.hxx>
#include <Geom_TrimmedCurve.hxx>
#include <Precision.hxx>
#include <TColStd_Array1OfInteger.hxx>
#include <TColStd_Array1OfReal.hxx>
#include <TColgp_Array1OfPnt.hxx>
#include <TopLoc_Location.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Shell.hxx>
#include <TopoDS_Solid.hxx>
#include <TopoDS_Wire.hxx>

#include <algorithm>
#include <stdexcept>
#include <vector>

#include "occt/bspline.h"
#include "occt/trimmed_face.h"
#include "softfold-kernel/src/bridge/occt.rs.h"

namespace softfold::occt {
namespace {

// Along u and v of the outline's bounds.
constexpr int gap_samples = 40;

// Above 0 where the second surface lies on the side of the first one's normal.
double gap(const Geom_Surface& lower, const Geom_Surface& upper, const gp_Pnt2d& uv) {
  gp_Pnt point;
  gp_Vec along_u, along_v;
  lower.D1(uv.X(), uv.Y(), point, along_u, along_v);
  return (along_u ^ along_v) * gp_Vec(point, upper.Value(uv.X(), uv.Y()));
}

// BRepCheck does not compare faces with each other, so a board that passes through itself would be valid. This compares
// the surfaces at a grid of points inside of the outline and on it.
void require_apart(const TopoDS_Face& face, const Geom_Surface& lower, const Geom_Surface& upper) {
  double u0, u1, v0, v1;
  BRepTools::UVBounds(face, u0, u1, v0, v1);
  const BRepTopAdaptor_FClass2d outline(face, Precision::PConfusion());
  double side = 0.0;
  for (int i = 0; i <= gap_samples; ++i)
    for (int j = 0; j <= gap_samples; ++j) {
      const gp_Pnt2d uv(u0 + (u1 - u0) * i / gap_samples, v0 + (v1 - v0) * j / gap_samples);
      if (outline.Perform(uv) == TopAbs_OUT) continue;
      const double here = gap(lower, upper, uv);
      if (here == 0.0 || here * side < 0.0)
        throw std::runtime_error("the surfaces meet near (u, v) = (" + std::to_string(uv.X()) + ", " +
                                 std::to_string(uv.Y()) + ")");
      side = here;
    }
}

// A straight edge over the parameters 0 to 1, which a ruled surface has along its rulings.
TopoDS_Edge post(const TopoDS_Vertex& foot, const TopoDS_Vertex& head) {
  TColgp_Array1OfPnt poles(1, 2);
  poles(1) = BRep_Tool::Pnt(foot);
  poles(2) = BRep_Tool::Pnt(head);
  if (poles(1).Distance(poles(2)) < Precision::Confusion())
    throw std::runtime_error("the surfaces meet at a corner of the outline");
  TColStd_Array1OfReal knots(1, 2);
  knots(1) = 0.0;
  knots(2) = 1.0;
  TColStd_Array1OfInteger multiplicities(1, 2);
  multiplicities.Init(2);
  BRepBuilderAPI_MakeEdge edge(new Geom_BSplineCurve(poles, knots, multiplicities, 1), foot, head, 0.0, 1.0);
  if (!edge.IsDone()) throw std::runtime_error("no edge between corners of the surfaces");
  return edge.Edge();
}

Handle(Geom_Curve) curve_of(const TopoDS_Edge& edge) {
  double first, last;
  const Handle(Geom_Curve) curve = BRep_Tool::Curve(edge, first, last);
  return new Geom_TrimmedCurve(curve, first, last);
}

Handle(Geom2d_Line) along(double u, double v, double du, double dv) {
  return new Geom2d_Line(gp_Pnt2d(u, v), gp_Dir2d(du, dv));
}

// The four edges of a side: bottom and top run the same way, left and right from bottom to top.
struct Side {
  TopoDS_Edge bottom, right, top, left;
};

void add_parameter_curves(const Side& side, const TopoDS_Face& face, double first, double last) {
  const double tolerance = Precision::Confusion();
  BRep_Builder builder;
  builder.UpdateEdge(side.bottom, along(0.0, 0.0, 1.0, 0.0), face, tolerance);
  builder.UpdateEdge(side.top, along(0.0, 1.0, 1.0, 0.0), face, tolerance);
  builder.UpdateEdge(side.left, along(first, 0.0, 0.0, 1.0), face, tolerance);
  builder.UpdateEdge(side.right, along(last, 0.0, 0.0, 1.0), face, tolerance);
}

TopoDS_Wire boundary(const Side& side) {
  BRep_Builder builder;
  TopoDS_Wire wire;
  builder.MakeWire(wire);
  builder.Add(wire, side.bottom);
  builder.Add(wire, side.right);
  builder.Add(wire, side.top.Reversed());
  builder.Add(wire, side.left.Reversed());
  wire.Closed(Standard_True);
  return wire;
}

TopoDS_Face ruled_face(const Side& side) {
  double first, last;
  BRep_Tool::Range(side.bottom, first, last);
  const Handle(Geom_Surface) surface = GeomFill::Surface(curve_of(side.bottom), curve_of(side.top));
  BRep_Builder builder;
  TopoDS_Face face;
  builder.MakeFace(face, surface, Precision::Confusion());
  add_parameter_curves(side, face, first, last);
  builder.Add(face, boundary(side));
  return face;
}

void add_sides(TopoDS_Shell& shell, const TrimLoop& lower, const TrimLoop& upper) {
  std::vector<TopoDS_Edge> posts;
  for (std::size_t i = 0; i < lower.corners.size(); ++i) posts.push_back(post(lower.corners[i], upper.corners[i]));
  for (std::size_t i = 0; i < posts.size(); ++i) {
    const Side side{lower.edges[i], posts[(i + 1) % posts.size()], upper.edges[i], posts[i]};
    BRep_Builder().Add(shell, ruled_face(side));
  }
}

}  // namespace

ShapePtr board_solid(const FlatSurface& lower_surface, const FlatSurface& upper_surface, const FlatLoops& loops) {
  const Handle(Geom_BSplineSurface) lower_geometry = clamped_surface(lower_surface);
  const Handle(Geom_BSplineSurface) upper_geometry = clamped_surface(upper_surface);
  const Surfaces both{lower_geometry, upper_geometry};
  const TrimmedFace lower = make_trimmed_face(lower_geometry, loops, both);
  const TrimmedFace upper = make_trimmed_face(upper_geometry, loops, both);
  require_apart(lower.face, *lower_geometry, *upper_geometry);
  BRep_Builder builder;
  TopoDS_Shell shell;
  builder.MakeShell(shell);
  builder.Add(shell, lower.face.Reversed());
  builder.Add(shell, upper.face);
  for (std::size_t i = 0; i < lower.loops.size(); ++i) add_sides(shell, lower.loops[i], upper.loops[i]);
  shell.Closed(Standard_True);
  TopoDS_Solid solid;
  builder.MakeSolid(solid);
  builder.Add(solid, shell);
  require_valid(solid, "the board");
  return wrap(outward(solid));
}

}  // namespace softfold::occt
