// A B-spline surface trimmed by loops of curves in its parameters.
#pragma once

#include <TopoDS_Edge.hxx>
#include <TopoDS_Face.hxx>
#include <TopoDS_Vertex.hxx>

#include <vector>

#include "occt/edge_curve.h"
#include "occt/shape.h"

namespace softfold::occt {

struct FlatLoops;
struct FlatSurface;

ShapePtr trimmed_face(const FlatSurface& surface, const FlatLoops& loops);

// Edge i runs from corner i to the next corner, around again at the end.
struct TrimLoop {
  std::vector<TopoDS_Vertex> corners;
  std::vector<TopoDS_Edge> edges;
};

struct TrimmedFace {
  TopoDS_Face face;
  std::vector<TrimLoop> loops;
};

// A valid face whose edges have their 3D curves. Faces that are made with the same partners, themselves among them, have
// curves with the same knots along the same trim curves.
TrimmedFace make_trimmed_face(const Handle(Geom_BSplineSurface) & surface, const FlatLoops& loops,
                              const Surfaces& partners);

}  // namespace softfold::occt
