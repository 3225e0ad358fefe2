#include "occt/faceted.h"

#include <BRepBuilderAPI_MakeEdge.hxx>
#include <BRepBuilderAPI_MakeFace.hxx>
#include <BRepBuilderAPI_MakeWire.hxx>
#include <BRep_Builder.hxx>
#include <BRep_Tool.hxx>
#include <Precision.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Edge.hxx>
#include <TopoDS_Shell.hxx>
#include <TopoDS_Solid.hxx>
#include <TopoDS_Vertex.hxx>

#include <map>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace softfold::occt {
namespace {

class Facets {
public:
  explicit Facets(Numbers positions) {
    for (std::size_t i = 0; i + 2 < positions.size(); i += 3) {
      TopoDS_Vertex& vertex = vertices.emplace_back();
      BRep_Builder().MakeVertex(vertex, gp_Pnt(positions[i], positions[i + 1], positions[i + 2]), Precision::Confusion());
    }
    BRep_Builder().MakeShell(shell);
  }

  void add(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    BRepBuilderAPI_MakeWire wire(edge(a, b), edge(b, c), edge(c, a));
    if (!wire.IsDone()) throw std::runtime_error("no wire around triangle " + std::to_string(count));
    BRepBuilderAPI_MakeFace face(wire.Wire(), Standard_True);
    if (!face.IsDone()) throw std::runtime_error("no face on triangle " + std::to_string(count));
    BRep_Builder().Add(shell, face.Face());
    ++count;
  }

  TopoDS_Shape whole() {
    for (const auto& [ends, used] : uses)
      if (used != 2) return shell;
    shell.Closed(Standard_True);
    TopoDS_Solid solid;
    BRep_Builder().MakeSolid(solid);
    BRep_Builder().Add(solid, shell);
    return outward(solid);
  }

private:
  TopoDS_Edge edge(std::uint32_t from, std::uint32_t to) {
    const auto ends = std::minmax(from, to);
    ++uses[ends];
    TopoDS_Edge& found = edges[ends];
    if (found.IsNull()) {
      BRepBuilderAPI_MakeEdge made(vertices.at(ends.first), vertices.at(ends.second));
      if (!made.IsDone()) throw std::runtime_error("triangle " + std::to_string(count) + " has two corners in one");
      found = made.Edge();
    }
    return from < to ? found : TopoDS::Edge(found.Reversed());
  }

  using Ends = std::pair<std::uint32_t, std::uint32_t>;
  std::vector<TopoDS_Vertex> vertices;
  std::map<Ends, TopoDS_Edge> edges;
  std::map<Ends, int> uses;
  TopoDS_Shell shell;
  std::size_t count = 0;
};

}  // namespace

ShapePtr faceted(Numbers positions, Indices triangles) {
  Facets facets(positions);
  for (std::size_t i = 0; i + 2 < triangles.size(); i += 3) facets.add(triangles[i], triangles[i + 1], triangles[i + 2]);
  return wrap(facets.whole());
}

}  // namespace softfold::occt
