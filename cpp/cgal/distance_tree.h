// Triangles in a tree that is asked for nearest points many times.
#pragma once

#include <memory>

#include "arrays.h"

namespace softfold::cgal {

class DistanceTree {
public:
  DistanceTree(Numbers positions, Indices triangles);
  ~DistanceTree();
  // The triangle nearest to each point; one of them where several are equally near.
  rust::Vec<std::uint32_t> nearest(Numbers points) const;

private:
  struct Parts;
  std::unique_ptr<Parts> parts;
};

std::unique_ptr<DistanceTree> distance_tree(Numbers positions, Indices triangles);

}  // namespace softfold::cgal
