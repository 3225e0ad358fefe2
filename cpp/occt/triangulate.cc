#include "occt/triangulate.h"

#include <BRepBuilderAPI_Copy.hxx>
#include <BRepMesh_IncrementalMesh.hxx>
#include <BRep_Tool.hxx>
#include <Poly_PolygonOnTriangulation.hxx>
#include <Poly_Triangulation.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopLoc_Location.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopoDS.hxx>

#include <map>
#include <optional>
#include <stdexcept>
#include <utility>
#include <vector>

#include "arrays.h"
#include "softfold-kernel/src/bridge/common.rs.h"

namespace softfold::occt {
namespace {

// Numbers the nodes of all faces so that a node on an edge or a vertex has one number in every face.
class Welder {
public:
  explicit Welder(const TopoDS_Shape& shape) {
    TopExp::MapShapes(shape, TopAbs_EDGE, edges);
    TopExp::MapShapes(shape, TopAbs_VERTEX, vertices);
  }

  void add(const TopoDS_Face& face) {
    TopLoc_Location place;
    const Handle(Poly_Triangulation) mesh = BRep_Tool::Triangulation(face, place);
    if (mesh.IsNull()) throw std::runtime_error("a face has no triangulation");
    Numbering numbers(mesh->NbNodes() + 1);
    for (TopExp_Explorer edge(face, TopAbs_EDGE); edge.More(); edge.Next())
      number_edge(TopoDS::Edge(edge.Current()), *mesh, place, numbers);
    for (int node = 1; node <= mesh->NbNodes(); ++node)
      if (!numbers[node]) numbers[node] = new_node(*mesh, place, node);
    add_triangles(*mesh, numbers, face.Orientation() == TopAbs_REVERSED);
  }

  FlatMesh result;

private:
  using Numbering = std::vector<std::optional<std::uint32_t>>;

  void number_edge(const TopoDS_Edge& edge, const Poly_Triangulation& mesh, const TopLoc_Location& place,
                   Numbering& numbers) {
    const Handle(Poly_PolygonOnTriangulation) polygon = BRep_Tool::PolygonOnTriangulation(edge, &mesh, place);
    if (polygon.IsNull()) return;
    const int edge_index = edges.FindIndex(edge);
    const TopoDS_Edge forward = TopoDS::Edge(edge.Oriented(TopAbs_FORWARD));
    const int first = vertices.FindIndex(TopExp::FirstVertex(forward));
    const int last = vertices.FindIndex(TopExp::LastVertex(forward));
    for (int i = 1; i <= polygon->NbNodes(); ++i) {
      Key key{edge_index, i};
      if (i == 1 && first) key = {0, first};
      if (i == polygon->NbNodes() && last) key = {0, last};
      number_node(key, mesh, place, polygon->Node(i), numbers);
    }
  }

  // An edge and the place along it, or 0 and a vertex.
  using Key = std::pair<int, int>;

  void number_node(Key key, const Poly_Triangulation& mesh, const TopLoc_Location& place, int node,
                   Numbering& numbers) {
    const auto known = shared.find(key);
    if (known != shared.end()) {
      numbers[node] = known->second;
    } else {
      if (!numbers[node]) numbers[node] = new_node(mesh, place, node);
      shared.emplace(key, *numbers[node]);
    }
  }

  std::uint32_t new_node(const Poly_Triangulation& mesh, const TopLoc_Location& place, int node) {
    const gp_Pnt p = mesh.Node(node).Transformed(place.Transformation());
    append(result.positions, p.X(), p.Y(), p.Z());
    return static_cast<std::uint32_t>(result.positions.size() / 3 - 1);
  }

  void add_triangles(const Poly_Triangulation& mesh, const Numbering& numbers, bool reversed) {
    for (int i = 1; i <= mesh.NbTriangles(); ++i) {
      int a, b, c;
      mesh.Triangle(i).Get(a, b, c);
      if (reversed) std::swap(b, c);
      const std::uint32_t p = *numbers[a], q = *numbers[b], r = *numbers[c];
      if (p != q && q != r && r != p) append(result.triangles, p, q, r);
    }
  }

  TopTools_IndexedMapOfShape edges, vertices;
  std::map<Key, std::uint32_t> shared;
};

}  // namespace

FlatMesh triangulate(const TopoDS_Shape& original, double linear, double angular) {
  // A copy: meshing writes into the shape, and a mesh of an earlier call must not be found there.
  const TopoDS_Shape shape = BRepBuilderAPI_Copy(original, Standard_False, Standard_False).Shape();
  BRepMesh_IncrementalMesh(shape, linear, Standard_False, angular, Standard_False);
  Welder welder(shape);
  for (TopExp_Explorer face(shape, TopAbs_FACE); face.More(); face.Next()) welder.add(TopoDS::Face(face.Current()));
  return std::move(welder.result);
}

}  // namespace softfold::occt
