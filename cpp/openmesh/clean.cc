#include "openmesh/clean.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <set>
#include <stdexcept>
#include <tuple>
#include <utility>
#include <vector>

#include "openmesh/mesh.h"
#include "softfold-kernel/src/bridge/openmesh.rs.h"

namespace softfold::openmesh {
namespace {

using Triangle = std::array<std::uint32_t, 3>;
using Edge = std::pair<std::uint32_t, std::uint32_t>;
using Cell = std::tuple<std::int64_t, std::int64_t, std::int64_t>;
using Point = OpenMesh::Vec3d;

std::vector<Point> points_of(Numbers positions) {
  std::vector<Point> points;
  for (std::size_t i = 0; i + 2 < positions.size(); i += 3)
    points.emplace_back(positions[i], positions[i + 1], positions[i + 2]);
  return points;
}

// The first vertex within `distance` of each, in the order of the input; a grid of that size holds those kept so far.
class Merger {
public:
  explicit Merger(double distance) : distance(distance), cell_size(distance > 0.0 ? distance : 1.0) {}

  std::uint32_t representative(std::uint32_t index, const std::vector<Point>& points) {
    const auto [x, y, z] = cell_of(points[index]);
    for (std::int64_t i = x - 1; i <= x + 1; ++i)
      for (std::int64_t j = y - 1; j <= y + 1; ++j)
        for (std::int64_t k = z - 1; k <= z + 1; ++k)
          for (const std::uint32_t kept : grid[{i, j, k}])
            if ((points[kept] - points[index]).norm() <= distance) return kept;
    grid[{x, y, z}].push_back(index);
    return index;
  }

private:
  Cell cell_of(const Point& p) const {
    const auto along = [&](double x) { return static_cast<std::int64_t>(std::floor(x / cell_size)); };
    return {along(p[0]), along(p[1]), along(p[2])};
  }

  double distance, cell_size;
  std::map<Cell, std::vector<std::uint32_t>> grid;
};

Edge edge_of(const Triangle& t, int side) { return std::minmax(t[side], t[(side + 1) % 3]); }

bool runs_up(const Triangle& t, int side) { return t[side] < t[(side + 1) % 3]; }

class Work {
public:
  Work(std::vector<Point> given, double merge) : points(std::move(given)), merger(merge) {}

  void add(Triangle t) {
    for (auto& corner : t) corner = merged(corner);
    Triangle sorted = t;
    std::sort(sorted.begin(), sorted.end());
    const bool degenerate = sorted[0] == sorted[1] || sorted[1] == sorted[2] || area(t) == 0.0;
    if (degenerate || !seen.insert(sorted).second || crowded(t)) {
      ++result.removed_triangles;
      return;
    }
    for (int side = 0; side < 3; ++side) neighbours[edge_of(t, side)].push_back(triangles.size());
    triangles.push_back(t);
  }

  void merge_all() {
    for (std::uint32_t i = 0; i < points.size(); ++i) {
      representatives.push_back(merger.representative(i, points));
      if (representatives[i] != i) ++result.merged_vertices;
    }
  }

  void orient() {
    piece.assign(triangles.size(), unvisited);
    for (std::size_t i = 0; i < triangles.size(); ++i)
      if (piece[i] == unvisited) orient_piece(i);
  }

  CleanedMesh finish() {
    Mesh mesh;
    for (const Point& point : points) mesh.add_vertex(point);
    for (const Triangle& t : triangles) {
      const auto vertex = [&](int k) { return Mesh::VertexHandle(static_cast<int>(t[k])); };
      if (!mesh.add_face(vertex(0), vertex(1), vertex(2)).is_valid()) ++result.removed_triangles;
    }
    if (mesh.n_faces() == 0) throw std::runtime_error("no triangle is left");
    FlatMesh flat = flat_mesh(mesh);
    result.positions = std::move(flat.positions);
    result.triangles = std::move(flat.triangles);
    return std::move(result);
  }

private:
  static constexpr int unvisited = -1;

  std::uint32_t merged(std::uint32_t vertex) const { return representatives[vertex]; }

  double area(const Triangle& t) const {
    return OpenMesh::cross(points[t[1]] - points[t[0]], points[t[2]] - points[t[0]]).norm();
  }

  // An edge has room for two triangles.
  bool crowded(const Triangle& t) const {
    for (int side = 0; side < 3; ++side) {
      const auto found = neighbours.find(edge_of(t, side));
      if (found != neighbours.end() && found->second.size() > 1) return true;
    }
    return false;
  }

  // Walks the piece from `seed`, turns what disagrees, then the whole piece if that was the lesser part or is inside out.
  void orient_piece(std::size_t seed) {
    std::vector<std::size_t> members{seed};
    std::vector<bool> turned{false};
    piece[seed] = 0;
    for (std::size_t next = 0; next < members.size(); ++next) {
      const Triangle t = triangles[members[next]];
      for (int side = 0; side < 3; ++side) visit_neighbours(t, side, members, turned);
    }
    const auto flips = static_cast<std::size_t>(std::count(turned.begin(), turned.end(), true));
    const bool turn_back = is_closed(members) ? volume(members) < 0.0 : 2 * flips > members.size();
    if (turn_back)
      for (const std::size_t member : members) std::swap(triangles[member][1], triangles[member][2]);
    result.flipped_triangles += static_cast<std::uint32_t>(turn_back ? members.size() - flips : flips);
  }

  void visit_neighbours(const Triangle& t, int side, std::vector<std::size_t>& members, std::vector<bool>& turned) {
    for (const std::size_t other : neighbours[edge_of(t, side)]) {
      if (piece[other] != unvisited) continue;
      piece[other] = 0;
      Triangle& o = triangles[other];
      int shared = 0;
      while (edge_of(o, shared) != edge_of(t, side)) ++shared;
      const bool agrees = runs_up(o, shared) != runs_up(t, side);
      if (!agrees) std::swap(o[1], o[2]);
      members.push_back(other);
      turned.push_back(!agrees);
    }
  }

  bool is_closed(const std::vector<std::size_t>& members) {
    return std::all_of(members.begin(), members.end(), [&](std::size_t member) {
      for (int side = 0; side < 3; ++side)
        if (neighbours[edge_of(triangles[member], side)].size() != 2) return false;
      return true;
    });
  }

  double volume(const std::vector<std::size_t>& members) const {
    const Point origin = points[triangles[members[0]][0]];
    double sum = 0.0;
    for (const std::size_t member : members) {
      const Triangle& t = triangles[member];
      sum += OpenMesh::dot(points[t[0]] - origin,
                           OpenMesh::cross(points[t[1]] - origin, points[t[2]] - origin));
    }
    return sum;
  }

  std::vector<Point> points;
  Merger merger;
  std::vector<std::uint32_t> representatives;
  std::vector<Triangle> triangles;
  std::set<Triangle> seen;
  std::map<Edge, std::vector<std::size_t>> neighbours;
  std::vector<int> piece;
  CleanedMesh result{};
};

}  // namespace

CleanedMesh clean(Numbers positions, Indices triangles, double merge) {
  quiet();
  Work work(points_of(positions), merge);
  work.merge_all();
  for (std::size_t i = 0; i + 2 < triangles.size(); i += 3)
    work.add({triangles[i], triangles[i + 1], triangles[i + 2]});
  work.orient();
  return work.finish();
}

}  // namespace softfold::openmesh
