#include "cgal/isotropic_remesh.h"

#include <CGAL/Polygon_mesh_processing/remesh.h>

#include "cgal/mesh.h"
#include "cgal/quiet.h"

namespace softfold::cgal {

namespace PMP = CGAL::Polygon_mesh_processing;

FlatMesh isotropic_remesh(Numbers positions, Indices triangles, double target_edge, std::uint32_t iterations) {
  quiet();
  Mesh mesh = mesh_of(positions, triangles);
  PMP::isotropic_remeshing(mesh.faces(), target_edge, mesh, PMP::parameters::number_of_iterations(iterations));
  mesh.collect_garbage();
  return flat_mesh(mesh);
}

}  // namespace softfold::cgal
