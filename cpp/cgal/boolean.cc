#include "cgal/boolean.h"

#include <CGAL/Polygon_mesh_processing/corefinement.h>
#include <CGAL/Polygon_mesh_processing/orientation.h>

#include "boolean_operation.h"
#include "cgal/mesh.h"
#include "cgal/quiet.h"

namespace softfold::cgal {
namespace {

namespace PMP = CGAL::Polygon_mesh_processing;

Mesh solid_of(Numbers positions, Indices triangles, const char* name) {
  Mesh mesh = mesh_of(positions, triangles);
  if (!CGAL::is_closed(mesh)) throw std::runtime_error(std::string(name) + " mesh is not closed");
  if (!PMP::is_outward_oriented(mesh)) throw std::runtime_error(std::string(name) + " mesh is not oriented outward");
  return mesh;
}

bool compute(Mesh& a, Mesh& b, Mesh& result, BooleanOperation operation) {
  const auto checked = PMP::parameters::throw_on_self_intersection(true);
  switch (operation) {
    case BooleanOperation::Union: return PMP::corefine_and_compute_union(a, b, result, checked);
    case BooleanOperation::Intersection: return PMP::corefine_and_compute_intersection(a, b, result, checked);
    case BooleanOperation::Difference: return PMP::corefine_and_compute_difference(a, b, result, checked);
  }
  throw std::invalid_argument("no such boolean operation");
}

}  // namespace

FlatMesh boolean(Numbers a_positions, Indices a_triangles, Numbers b_positions, Indices b_triangles,
                 std::uint8_t operation) {
  quiet();
  Mesh a = solid_of(a_positions, a_triangles, "the first");
  Mesh b = solid_of(b_positions, b_triangles, "the second");
  Mesh result;
  try {
    if (!compute(a, b, result, BooleanOperation{operation}))
      throw std::runtime_error("the result would not be manifold; move one solid a little");
  } catch (const PMP::Corefinement::Self_intersection_exception&) {
    throw std::runtime_error("a mesh intersects itself where the two meet");
  }
  return flat_mesh(result);
}

}  // namespace softfold::cgal
