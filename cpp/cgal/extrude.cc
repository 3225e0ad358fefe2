#include "cgal/extrude.h"

#include <CGAL/Polygon_mesh_processing/extrude.h>
#include <CGAL/Polygon_mesh_processing/measure.h>
#include <CGAL/Polygon_mesh_processing/orientation.h>

#include "cgal/mesh.h"
#include "cgal/quiet.h"

namespace softfold::cgal {

namespace PMP = CGAL::Polygon_mesh_processing;

FlatMesh extrude(Numbers positions, Indices triangles, std::array<double, 3> v) {
  quiet();
  const Mesh sheet = mesh_of(positions, triangles);
  if (CGAL::is_closed(sheet)) throw std::runtime_error("the mesh is closed: there is no border to put sides on");
  Mesh solid;
  PMP::extrude_mesh(sheet, solid, Kernel::Vector_3(v[0], v[1], v[2]));
  if (PMP::volume(solid) < 0) PMP::reverse_face_orientations(solid);
  return flat_mesh(solid);
}

}  // namespace softfold::cgal
