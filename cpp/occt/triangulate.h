// Triangles of a shape's faces, with common vertices along common edges.
#pragma once

#include <TopoDS_Shape.hxx>

namespace softfold {
struct FlatMesh;
}

namespace softfold::occt {
FlatMesh triangulate(const TopoDS_Shape& shape, double linear, double angular);
}
