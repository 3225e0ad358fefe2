// A decimation module that bounds how far the new surface lies from the first one.
//
// OpenMesh's Hausdorff module bounds how far the first mesh's vertices lie from the new surface. That is one side only:
// along a straight border all vertices but two may go, and the triangles left cut through the curved strip beside it.
// Here every face carries a bound of its distance from the first surface. A collapse compares the faces it would make
// with those it would replace, at a grid of points, and adds what those carry.
#pragma once

#include <OpenMesh/Tools/Decimater/ModBaseT.hh>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

namespace softfold::openmesh {

template <typename Point>
double squared_distance_to_segment(const Point& p, const Point& a, const Point& b) {
  const Point ab = b - a;
  const double length = ab.sqrnorm();
  const double t = length > 0.0 ? std::clamp(((p - a) | ab) / length, 0.0, 1.0) : 0.0;
  return (p - (a + ab * t)).sqrnorm();
}

template <typename Point>
double squared_distance(const Point& p, const std::array<Point, 3>& t) {
  const Point normal = (t[1] - t[0]) % (t[2] - t[0]);
  const double area = normal.sqrnorm();
  const auto is_left_of = [&](int side) { return ((normal % (t[(side + 1) % 3] - t[side])) | (p - t[side])) >= 0.0; };
  if (area > 0.0 && is_left_of(0) && is_left_of(1) && is_left_of(2)) {
    const double height = (p - t[0]) | normal;
    return height * height / area;
  }
  double least = std::numeric_limits<double>::max();
  for (int side = 0; side < 3; ++side)
    least = std::min(least, squared_distance_to_segment(p, t[side], t[(side + 1) % 3]));
  return least;
}

template <typename MeshT>
class SurfaceError : public OpenMesh::Decimater::ModBaseT<MeshT> {
public:
  DECIMATING_MODULE(SurfaceError, MeshT, SurfaceError);

  explicit SurfaceError(MeshT& mesh) : Base(mesh, true) { mesh.add_property(errors); }
  ~SurfaceError() override { Base::mesh().remove_property(errors); }
  SurfaceError(const SurfaceError&) = delete;
  SurfaceError& operator=(const SurfaceError&) = delete;

  void set_max_error(double value) { max_error = value; }

  void initialize() override {
    for (const auto face : Base::mesh().faces()) Base::mesh().property(errors, face) = 0.0;
  }

  float collapse_priority(const CollapseInfo& collapse) override {
    return static_cast<float>(new_errors(collapse) ? Base::LEGAL_COLLAPSE : Base::ILLEGAL_COLLAPSE);
  }

  void preprocess_collapse(const CollapseInfo& collapse) override { new_errors(collapse); }

  void postprocess_collapse(const CollapseInfo&) override {
    for (const auto& [face, error] : changed) Base::mesh().property(errors, face) = error;
  }

private:
  using Point = typename MeshT::Point;
  using Triangle = std::array<Point, 3>;

  struct OldFace {
    Triangle corners;
    double error;
  };

  // Fills `changed` with the faces that stay and what they would carry; false as soon as one is above the bound.
  bool new_errors(const CollapseInfo& collapse) {
    collect_old_faces(collapse);
    changed.clear();
    for (const auto face : Base::mesh().vf_range(collapse.v0)) {
      if (face == collapse.fl || face == collapse.fr) continue;
      const double error = error_of(corners_of(face, collapse));
      if (error > max_error) return false;
      changed.emplace_back(face, error);
    }
    return true;
  }

  void collect_old_faces(const CollapseInfo& collapse) {
    old_faces.clear();
    for (const auto face : Base::mesh().vf_range(collapse.v0))
      old_faces.push_back({corners_of(face, {}), Base::mesh().property(errors, face)});
  }

  Triangle corners_of(typename MeshT::FaceHandle face, const std::optional<CollapseInfo>& collapse) {
    Triangle corners;
    std::size_t corner = 0;
    for (const auto vertex : Base::mesh().fv_range(face))
      corners[corner++] = collapse && vertex == collapse->v0 ? collapse->p1 : Base::mesh().point(vertex);
    return corners;
  }

  // The largest at a grid of points without the corners, which are on the surface; or the first above the bound.
  double error_of(const Triangle& t) const {
    constexpr int steps = 3;
    double worst = 0.0;
    for (int i = 0; i <= steps; ++i)
      for (int j = 0; i + j <= steps; ++j) {
        if (std::max({i, j, steps - i - j}) == steps) continue;
        const double a = double(i) / steps, b = double(j) / steps;
        worst = std::max(worst, error_at(t[0] * a + t[1] * b + t[2] * (1.0 - a - b)));
        if (worst > max_error) return worst;
      }
    return worst;
  }

  // From any old face is an upper bound, so a good one is good enough.
  double error_at(const Point& point) const {
    constexpr double good_enough = 0.01;
    double least = std::numeric_limits<double>::max();
    for (const OldFace& face : old_faces) {
      least = std::min(least, std::sqrt(squared_distance(point, face.corners)) + face.error);
      if (least <= good_enough * max_error) break;
    }
    return least;
  }

  OpenMesh::FPropHandleT<double> errors;
  double max_error = 0.0;
  std::vector<OldFace> old_faces;
  std::vector<std::pair<typename MeshT::FaceHandle, double>> changed;
};

}  // namespace softfold::openmesh
