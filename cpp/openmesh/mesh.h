// Half-edge meshes from flat arrays and back. For .cc files only: it pulls in OpenMesh.
#pragma once

#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>

#include <stdexcept>
#include <string>
#include <vector>

#include "arrays.h"
#include "softfold-kernel/src/bridge/common.rs.h"

namespace softfold::openmesh {

struct Traits : OpenMesh::DefaultTraits {
  using Point = OpenMesh::Vec3d;
  using Normal = OpenMesh::Vec3d;
  VertexAttributes(OpenMesh::Attributes::Status);
  EdgeAttributes(OpenMesh::Attributes::Status);
  HalfedgeAttributes(OpenMesh::Attributes::Status);
  FaceAttributes(OpenMesh::Attributes::Status | OpenMesh::Attributes::Normal);
};

using Mesh = OpenMesh::TriMesh_ArrayKernelT<Traits>;

// OpenMesh reports on stderr; what it says there comes back as errors of ours. Its streams are global: they are written
// once, by whichever thread comes first.
inline void quiet() {
  static const bool once = [] {
    omlog().disable();
    omout().disable();
    omerr().disable();
    return true;
  }();
  static_cast<void>(once);
}

// Vertices without triangles are left out.
inline FlatMesh flat_mesh(const Mesh& mesh) {
  FlatMesh flat;
  std::vector<std::uint32_t> numbers(mesh.n_vertices());
  std::uint32_t count = 0;
  for (const auto vertex : mesh.vertices()) {
    if (mesh.is_isolated(vertex)) continue;
    numbers[vertex.idx()] = count++;
    const auto& p = mesh.point(vertex);
    append(flat.positions, p[0], p[1], p[2]);
  }
  for (const auto face : mesh.faces())
    for (const auto vertex : mesh.fv_range(face)) append(flat.triangles, numbers[vertex.idx()]);
  return flat;
}

}  // namespace softfold::openmesh
