#include "openmesh/decimate.h"

#include <OpenMesh/Tools/Decimater/DecimaterT.hh>
#include <OpenMesh/Tools/Decimater/ModHausdorffT.hh>
#include <OpenMesh/Tools/Decimater/ModNormalFlippingT.hh>
#include <OpenMesh/Tools/Decimater/ModQuadricT.hh>

#include "openmesh/mesh.h"
#include "openmesh/surface_error.h"

namespace softfold::openmesh {
namespace {

using Decimater = OpenMesh::Decimater::DecimaterT<Mesh>;
using Quadric = OpenMesh::Decimater::ModQuadricT<Mesh>;
using Hausdorff = OpenMesh::Decimater::ModHausdorffT<Mesh>;
using Surface = SurfaceError<Mesh>;
using NormalFlipping = OpenMesh::Decimater::ModNormalFlippingT<Mesh>;

// No normal may turn by this much in one collapse.
constexpr float largest_turn_deg = 60.0F;

Mesh mesh_of(Numbers positions, Indices triangles) {
  Mesh mesh;
  for (std::size_t i = 0; i + 2 < positions.size(); i += 3)
    mesh.add_vertex({positions[i], positions[i + 1], positions[i + 2]});
  for (std::size_t i = 0; i + 2 < triangles.size(); i += 3) {
    const auto vertex = [&](std::size_t k) { return Mesh::VertexHandle(static_cast<int>(triangles[i + k])); };
    const bool degenerate =
        triangles[i] == triangles[i + 1] || triangles[i + 1] == triangles[i + 2] || triangles[i + 2] == triangles[i];
    if (degenerate || !mesh.add_face(vertex(0), vertex(1), vertex(2)).is_valid())
      throw std::runtime_error("triangle " + std::to_string(i / 3) +
                               " does not fit: the mesh is no oriented manifold; clean it first");
  }
  return mesh;
}

}  // namespace

// The quadric orders collapses, the other modules bound them. The quadric's own limit would bound a sum of squares
// weighted by area, which is no distance.
FlatMesh decimate(Numbers positions, Indices triangles, double max_error) {
  quiet();
  Mesh mesh = mesh_of(positions, triangles);
  mesh.update_face_normals();
  Decimater decimater(mesh);
  Quadric::Handle quadric;
  Hausdorff::Handle hausdorff;
  Surface::Handle surface;
  NormalFlipping::Handle flipping;
  decimater.add(quadric);
  decimater.add(flipping);  // the cheapest first: one refusal ends the asking
  decimater.add(hausdorff);
  decimater.add(surface);
  decimater.module(quadric).unset_max_err();
  decimater.module(hausdorff).set_tolerance(max_error);
  decimater.module(surface).set_max_error(max_error);
  decimater.module(flipping).set_max_normal_deviation(largest_turn_deg);
  if (!decimater.initialize()) throw std::runtime_error("the decimation cannot start");
  decimater.decimate();
  mesh.garbage_collection();
  return flat_mesh(mesh);
}

}  // namespace softfold::openmesh
