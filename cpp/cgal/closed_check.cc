#include "cgal/closed_check.h"

#include <CGAL/Polygon_mesh_processing/orientation.h>
#include <CGAL/Polygon_mesh_processing/repair.h>

#include <algorithm>
#include <iterator>
#include <map>
#include <utility>
#include <vector>

#include "cgal/mesh.h"
#include "cgal/quiet.h"
#include "softfold-kernel/src/bridge/cgal.rs.h"

namespace softfold::cgal {
namespace {

namespace PMP = CGAL::Polygon_mesh_processing;

// Every edge is run through as often one way as the other: holds for solids that touch each other too.
bool is_closed(Indices triangles) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> balance;
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    const std::uint32_t from = triangles[i], to = triangles[i % 3 == 2 ? i - 2 : i + 1];
    balance[std::minmax(from, to)] += from < to ? 1 : -1;
  }
  return std::all_of(balance.begin(), balance.end(), [](const auto& edge) { return edge.second == 0; });
}

double signed_volume(Numbers positions, Indices triangles) {
  double volume = 0.0;
  const auto point = [&](std::size_t corner) {
    const double* p = positions.data() + 3 * std::size_t{triangles[corner]};
    return Kernel::Vector_3(p[0] - positions[0], p[1] - positions[1], p[2] - positions[2]);
  };
  for (std::size_t i = 0; i + 2 < triangles.size(); i += 3)
    volume += CGAL::determinant(point(i), point(i + 1), point(i + 2)) / 6.0;
  return volume;
}

// All vertices in one pass: CGAL's question about a single one walks through the whole mesh.
bool is_manifold(const Mesh& mesh) {
  std::vector<Mesh::Halfedge_index> pinched;
  PMP::non_manifold_vertices(mesh, std::back_inserter(pinched));
  return pinched.empty();
}

}  // namespace

Closedness closed_check(Numbers positions, Indices triangles) {
  quiet();
  std::vector<std::size_t> refused;
  const Mesh mesh = mesh_of(positions, triangles, &refused);
  Closedness found{is_closed(triangles), refused.empty() && is_manifold(mesh), false,
                   signed_volume(positions, triangles)};
  found.outward = found.closed && found.manifold && found.volume > 0.0 && PMP::is_outward_oriented(mesh);
  return found;
}

}  // namespace softfold::cgal
