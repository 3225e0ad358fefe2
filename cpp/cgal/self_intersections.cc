#include "cgal/self_intersections.h"

#include <CGAL/Polygon_mesh_processing/self_intersections.h>

#include <algorithm>
#include <iterator>
#include <utility>
#include <vector>

#include "cgal/mesh.h"
#include "cgal/quiet.h"

namespace softfold::cgal {

rust::Vec<std::uint32_t> self_intersections(Numbers positions, Indices triangles) {
  quiet();
  const Mesh mesh = mesh_of(positions, triangles);
  std::vector<std::pair<Mesh::Face_index, Mesh::Face_index>> found;
  CGAL::Polygon_mesh_processing::self_intersections(mesh, std::back_inserter(found));
  for (auto& [a, b] : found)
    if (b < a) std::swap(a, b);
  std::sort(found.begin(), found.end());
  rust::Vec<std::uint32_t> pairs;
  for (const auto& [a, b] : found) append(pairs, a.idx(), b.idx());
  return pairs;
}

}  // namespace softfold::cgal
