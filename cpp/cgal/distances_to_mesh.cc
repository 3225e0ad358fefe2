#include "cgal/distances_to_mesh.h"

#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/AABB_triangle_primitive.h>
#include <CGAL/Simple_cartesian.h>

#include <cmath>
#include <stdexcept>
#include <vector>

#include "cgal/quiet.h"

namespace softfold::cgal {
namespace {

using Kernel = CGAL::Simple_cartesian<double>;
using Point = Kernel::Point_3;
using Triangles = std::vector<Kernel::Triangle_3>;
using Primitive = CGAL::AABB_triangle_primitive<Kernel, Triangles::const_iterator>;
using Tree = CGAL::AABB_tree<CGAL::AABB_traits<Kernel, Primitive>>;

Point point_at(Numbers numbers, std::size_t i) {
  return {numbers[3 * i], numbers[3 * i + 1], numbers[3 * i + 2]};
}

// Degenerate triangles are left out: they have no plane to project to.
Triangles triangles_of(Numbers positions, Indices indices) {
  Triangles triangles;
  for (std::size_t i = 0; i + 2 < indices.size(); i += 3) {
    const Kernel::Triangle_3 triangle(point_at(positions, indices[i]), point_at(positions, indices[i + 1]),
                                      point_at(positions, indices[i + 2]));
    if (!triangle.is_degenerate()) triangles.push_back(triangle);
  }
  if (triangles.empty()) throw std::runtime_error("all triangles are degenerate");
  return triangles;
}

}  // namespace

rust::Vec<double> distances_to_mesh(Numbers points, Numbers positions, Indices indices) {
  quiet();
  const Triangles triangles = triangles_of(positions, indices);
  Tree tree(triangles.begin(), triangles.end());
  tree.accelerate_distance_queries();
  rust::Vec<double> distances;
  distances.reserve(points.size() / 3);
  for (std::size_t i = 0; i < points.size() / 3; ++i)
    distances.push_back(std::sqrt(tree.squared_distance(point_at(points, i))));
  return distances;
}

}  // namespace softfold::cgal
