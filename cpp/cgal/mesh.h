// Half-edge meshes from flat arrays and back. For .cc files only: it pulls in CGAL.
#pragma once

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Surface_mesh.h>

#include <array>
#include <stdexcept>
#include <string>
#include <vector>

#include "arrays.h"
#include "softfold-kernel/src/bridge/common.rs.h"

namespace softfold::cgal {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Point = Kernel::Point_3;
using Mesh = CGAL::Surface_mesh<Point>;

inline std::vector<Point> points_of(Numbers positions) {
  std::vector<Point> points;
  points.reserve(positions.size() / 3);
  for (std::size_t i = 0; i + 2 < positions.size(); i += 3)
    points.emplace_back(positions[i], positions[i + 1], positions[i + 2]);
  return points;
}

// The triangles that found no place are listed in `refused`; without it, the first one throws.
inline Mesh mesh_of(Numbers positions, Indices triangles, std::vector<std::size_t>* refused = nullptr) {
  Mesh mesh;
  for (const Point& point : points_of(positions)) mesh.add_vertex(point);
  for (std::size_t i = 0; i + 2 < triangles.size(); i += 3) {
    const Mesh::Vertex_index a(triangles[i]), b(triangles[i + 1]), c(triangles[i + 2]);
    const bool degenerate = a == b || b == c || c == a;
    if (!degenerate && mesh.add_face(a, b, c) != Mesh::null_face()) continue;
    if (!refused)
      throw std::runtime_error("triangle " + std::to_string(i / 3) +
                               " does not fit: the mesh is no oriented manifold; clean it first");
    refused->push_back(i / 3);
  }
  return mesh;
}

// Vertices without triangles are left out.
inline FlatMesh flat_mesh(Mesh& mesh) {
  FlatMesh flat;
  std::vector<std::uint32_t> numbers(mesh.num_vertices() + mesh.number_of_removed_vertices());
  std::uint32_t count = 0;
  for (const auto vertex : mesh.vertices()) {
    if (mesh.is_isolated(vertex)) continue;
    numbers[vertex] = count++;
    const Point& p = mesh.point(vertex);
    append(flat.positions, p.x(), p.y(), p.z());
  }
  for (const auto face : mesh.faces()) {
    std::array<std::uint32_t, 3> corners{};
    std::size_t corner = 0;
    for (const auto vertex : CGAL::vertices_around_face(mesh.halfedge(face), mesh))
      if (corner < 3) corners[corner++] = numbers[vertex];
    append(flat.triangles, corners[0], corners[1], corners[2]);
  }
  return flat;
}

}  // namespace softfold::cgal
