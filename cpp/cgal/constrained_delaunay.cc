#include "cgal/constrained_delaunay.h"

#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Constrained_triangulation_plus_2.h>
#include <CGAL/Exact_predicates_exact_constructions_kernel.h>
#include <CGAL/Spatial_sort_traits_adapter_2.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>
#include <CGAL/property_map.h>
#include <CGAL/spatial_sort.h>

#include <algorithm>
#include <limits>
#include <numeric>
#include <stdexcept>
#include <vector>

#include "cgal/quiet.h"
#include "softfold-kernel/src/bridge/cgal.rs.h"

namespace softfold::cgal {
namespace {

constexpr std::uint32_t unnumbered = std::numeric_limits<std::uint32_t>::max();

struct Number {
  std::uint32_t value = unnumbered;
};

// Exact constructions: crossings of constraints are exact points, and cross on exactly.
using Kernel = CGAL::Exact_predicates_exact_constructions_kernel;
using Point = Kernel::Point_2;
using VertexBase = CGAL::Triangulation_vertex_base_with_info_2<Number, Kernel>;
using FaceBase = CGAL::Constrained_triangulation_face_base_2<Kernel>;
using Structure = CGAL::Triangulation_data_structure_2<VertexBase, FaceBase>;
using Delaunay = CGAL::Constrained_Delaunay_triangulation_2<Kernel, Structure, CGAL::Exact_intersections_tag>;
using Triangulation = CGAL::Constrained_triangulation_plus_2<Delaunay>;
using Vertex = Triangulation::Vertex_handle;

class Work {
public:
  explicit Work(Numbers numbers) {
    // Of a lazy number CGAL else gives 5 digits: nearly parallel constraints then cross that far off.
    CGAL::Lazy_exact_nt<Kernel::FT::ET>::set_relative_precision_of_to_double(std::numeric_limits<double>::epsilon() / 2);
    insert_points(numbers);
    for (const Vertex vertex : inputs) append(flat.index_of_input, number(vertex));
  }

  void constrain(std::uint32_t a, std::uint32_t b) {
    const bool long_enough = inputs[a] != inputs[b];
    constraints.push_back({inputs[a], long_enough ? triangulation.insert_constraint(inputs[a], inputs[b]) : Id()});
  }

  FlatTriangulation finish() {
    if (triangulation.dimension() < 2) throw std::runtime_error("all points lie on one line");
    for (std::uint32_t input = 0; input < constraints.size(); ++input) write_pieces(input);
    for (const auto face : triangulation.finite_face_handles())
      for (int corner = 0; corner < 3; ++corner) append(flat.triangles, face->vertex(corner)->info().value);
    return std::move(flat);
  }

private:
  using Id = Triangulation::Constraint_id;

  struct Constraint {
    Vertex first;
    Id id;
  };

  // In an order that keeps neighbours together: each insertion starts where the last one ended.
  void insert_points(Numbers numbers) {
    std::vector<Point> points;
    for (std::size_t i = 0; i + 1 < numbers.size(); i += 2) points.emplace_back(numbers[i], numbers[i + 1]);
    inputs.resize(points.size());
    Triangulation::Face_handle hint;
    for (const std::size_t i : spatial_order(points)) {
      inputs[i] = triangulation.insert(points[i], hint);
      hint = inputs[i]->face();
    }
  }

  static std::vector<std::size_t> spatial_order(const std::vector<Point>& points) {
    std::vector<std::size_t> order(points.size());
    std::iota(order.begin(), order.end(), 0);
    const auto map = CGAL::make_property_map(points);
    CGAL::spatial_sort(order.begin(), order.end(),
                       CGAL::Spatial_sort_traits_adapter_2<Kernel, CGAL::Pointer_property_map<Point>::const_type>(map));
    return order;
  }

  // The vertex's number in the result; the first call for a vertex writes its point.
  std::uint32_t number(Vertex vertex) {
    if (vertex->info().value == unnumbered) {
      vertex->info().value = static_cast<std::uint32_t>(flat.points.size() / 2);
      append(flat.points, CGAL::to_double(vertex->point().x()), CGAL::to_double(vertex->point().y()));
    }
    return vertex->info().value;
  }

  void write_pieces(std::uint32_t input) {
    const Constraint& constraint = constraints[input];
    if (constraint.id == Id()) return;
    std::vector<Vertex> chain(triangulation.vertices_in_constraint_begin(constraint.id),
                              triangulation.vertices_in_constraint_end(constraint.id));
    if (chain.front() != constraint.first) std::reverse(chain.begin(), chain.end());
    for (std::size_t i = 0; i + 1 < chain.size(); ++i) {
      const std::uint32_t from = number(chain[i]), to = number(chain[i + 1]);
      append(flat.constraints, from, to, input);
    }
  }

  Triangulation triangulation;
  std::vector<Vertex> inputs;
  std::vector<Constraint> constraints;
  FlatTriangulation flat;
};

}  // namespace

FlatTriangulation constrained_delaunay(Numbers points, Indices constraints) {
  quiet();
  Work work(points);
  for (std::uint32_t i = 0; 2 * i + 1 < constraints.size(); ++i)
    work.constrain(constraints[2 * i], constraints[2 * i + 1]);
  return work.finish();
}

}  // namespace softfold::cgal
