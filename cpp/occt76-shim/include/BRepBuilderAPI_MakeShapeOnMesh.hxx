// OCCT 7.7's class of this name, declared for opencascade-sys on OCCT 7.6. Nothing here calls it; it is never done.
#pragma once

#include <BRepBuilderAPI_MakeShape.hxx>
#include <Message_ProgressRange.hxx>
#include <Poly_Triangulation.hxx>

class BRepBuilderAPI_MakeShapeOnMesh : public BRepBuilderAPI_MakeShape {
public:
  explicit BRepBuilderAPI_MakeShapeOnMesh(const Handle(Poly_Triangulation) & /*mesh*/) {}

  void Build(const Message_ProgressRange& = Message_ProgressRange()) Standard_OVERRIDE { NotDone(); }
};
