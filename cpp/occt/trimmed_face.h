// A B-spline surface trimmed by loops of curves in its parameters.
#pragma once

#include <Geom_Surface.hxx>
#include <TopoDS_Edge.hxx>
#include <TopoDS_Face.hxx>
#include <TopoDS_Vertex.hxx>

#include <vector>

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

// A valid face whose edges have their 3D curves.
TrimmedFace make_trimmed_face(const Handle(Geom_Surface) & surface, const FlatLoops& loops);

}  // namespace softfold::occt
