#include "cgal/convex_hull.h"

#include <CGAL/Convex_hull_traits_adapter_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/convex_hull_2.h>
#include <CGAL/property_map.h>

#include <iterator>
#include <numeric>
#include <vector>

#include "cgal/quiet.h"

namespace softfold::cgal {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Points = std::vector<Kernel::Point_2>;
using Map = CGAL::Pointer_property_map<Kernel::Point_2>::const_type;

rust::Vec<std::uint32_t> convex_hull(Numbers numbers) {
  quiet();
  Points points;
  for (std::size_t i = 0; i + 1 < numbers.size(); i += 2) points.emplace_back(numbers[i], numbers[i + 1]);
  std::vector<std::uint32_t> order(points.size()), corners;
  std::iota(order.begin(), order.end(), 0);
  const CGAL::Convex_hull_traits_adapter_2<Kernel, Map> traits(
      CGAL::make_property_map(static_cast<const Points&>(points)));
  CGAL::convex_hull_2(order.begin(), order.end(), std::back_inserter(corners), traits);
  rust::Vec<std::uint32_t> result;
  for (const std::uint32_t corner : corners) result.push_back(corner);
  return result;
}

}  // namespace softfold::cgal
