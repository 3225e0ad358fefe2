// OCCT 7.7's class of this name, for opencascade-sys on OCCT 7.6. In 7.6 the same computation lies in TKV3d, which
// would pull in X11 and OpenGL; here it is written out: facet normals first, surface normals where they exist.
#pragma once

#include <BRep_Tool.hxx>
#include <GeomLib.hxx>
#include <Geom_Surface.hxx>
#include <Poly_Triangulation.hxx>
#include <Precision.hxx>
#include <TopLoc_Location.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Face.hxx>
#include <gp_Dir.hxx>

class BRepLib_ToolTriangulatedShape {
public:
  static void ComputeNormals(const TopoDS_Face& face, const Handle(Poly_Triangulation) & mesh) {
    if (mesh.IsNull() || mesh->HasNormals()) return;
    mesh->ComputeNormals();
    const TopoDS_Face unplaced = TopoDS::Face(face.Located(TopLoc_Location()));
    const Handle(Geom_Surface) surface = BRep_Tool::Surface(unplaced);
    if (surface.IsNull() || !mesh->HasUVNodes()) return;
    for (Standard_Integer node = 1; node <= mesh->NbNodes(); ++node) {
      gp_Dir normal;
      const bool defined = GeomLib::NormEstim(surface, mesh->UVNode(node), Precision::Confusion(), normal) <= 1;
      if (defined) mesh->SetNormal(node, normal);
    }
  }
};
