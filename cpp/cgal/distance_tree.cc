#include "cgal/distance_tree.h"

#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/AABB_triangle_primitive.h>
#include <CGAL/Simple_cartesian.h>

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

}  // namespace

struct DistanceTree::Parts {
  Triangles triangles;
  std::vector<std::uint32_t> number;  // of each in the input
  Tree tree;
};

// Degenerate triangles are left out: they have no plane to project to.
DistanceTree::DistanceTree(Numbers positions, Indices indices) : parts(std::make_unique<Parts>()) {
  quiet();
  for (std::size_t i = 0; i + 2 < indices.size(); i += 3) {
    const Kernel::Triangle_3 triangle(point_at(positions, indices[i]), point_at(positions, indices[i + 1]),
                                      point_at(positions, indices[i + 2]));
    if (triangle.is_degenerate()) continue;
    parts->triangles.push_back(triangle);
    parts->number.push_back(static_cast<std::uint32_t>(i / 3));
  }
  if (parts->triangles.empty()) throw std::runtime_error("all triangles are degenerate");
  parts->tree.insert(parts->triangles.cbegin(), parts->triangles.cend());
  parts->tree.build();
  parts->tree.accelerate_distance_queries();
}

DistanceTree::~DistanceTree() = default;

rust::Vec<std::uint32_t> DistanceTree::nearest(Numbers points) const {
  rust::Vec<std::uint32_t> found;
  found.reserve(points.size() / 3);
  for (std::size_t i = 0; i < points.size() / 3; ++i) {
    const auto triangle = parts->tree.closest_point_and_primitive(point_at(points, i)).second;
    found.push_back(parts->number[triangle - parts->triangles.cbegin()]);
  }
  return found;
}

std::unique_ptr<DistanceTree> distance_tree(Numbers positions, Indices triangles) {
  return std::make_unique<DistanceTree>(positions, triangles);
}

}  // namespace softfold::cgal
