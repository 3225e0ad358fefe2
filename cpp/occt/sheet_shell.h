// Trimmed faces that share edges and corners.
#pragma once

#include <TopoDS_Edge.hxx>
#include <TopoDS_Face.hxx>
#include <TopoDS_Shell.hxx>

#include <vector>

#include "occt/shape.h"
#include "rust/cxx.h"

namespace softfold::occt {

struct FlatSheetShell;
struct FlatSurface;

ShapePtr sheet_shell(const rust::Vec<FlatSurface>& surfaces, const FlatSheetShell& shell);

struct SheetShell {
  TopoDS_Shell shell;
  std::vector<TopoDS_Edge> edges;
  // How many faces use each edge.
  std::vector<int> uses;
};

// A valid shell: every corner one vertex, every edge one edge with a 3D curve and a curve in the parameters of each face.
SheetShell make_sheet_shell(const rust::Vec<FlatSurface>& surfaces, const FlatSheetShell& flat);

}  // namespace softfold::occt
