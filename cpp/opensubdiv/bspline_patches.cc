// OpenSubdiv leaves out the control points past the border and marks the sides where they are missing. Here they are
// added as 2 a - b: with those the border of the patch is the B-spline of the border's vertices, as the crease rule
// wants it.
#include "opensubdiv/bspline_patches.h"

#include <opensubdiv/far/patchTableFactory.h>
#include <opensubdiv/far/stencilTableFactory.h>

#include <array>
#include <map>
#include <memory>
#include <stdexcept>
#include <utility>
#include <vector>

#include "opensubdiv/refiner.h"
#include "softfold-kernel/src/bridge/opensubdiv.rs.h"

namespace softfold::opensubdiv {
namespace {

using namespace OpenSubdiv;
using Patch = std::array<int, 16>;
using Row = std::map<int, double>;
using Stencils = Far::StencilTableReal<double>;
using StencilFactory = Far::StencilTableFactoryReal<double>;

// Bits of PatchParam::GetBoundary.
enum Side { bottom = 1, right = 2, top = 4, left = 8 };

Far::PatchTableFactory::Options patch_options(int isolation) {
  Far::PatchTableFactory::Options options(isolation);
  options.SetEndCapType(Far::PatchTableFactory::Options::ENDCAP_BSPLINE_BASIS);
  options.SetPatchPrecision<double>();
  options.useInfSharpPatch = true;  // borders are exact patches, not refined ones
  options.generateLegacySharpCornerPatches = false;
  return options;
}

// One row per refined vertex, then one per local point.
std::unique_ptr<const Stencils> point_stencils(const Far::TopologyRefiner& refiner, const Far::PatchTable& patches,
                                               int isolation) {
  StencilFactory::Options options;
  options.generateIntermediateLevels = true;
  options.generateOffsets = true;
  options.maxLevel = isolation;
  std::unique_ptr<const Stencils> refined(StencilFactory::Create(refiner, options));
  const Stencils* local = patches.GetLocalPointStencilTable<double>();
  if (!local || local->GetNumStencils() == 0) return refined;
  return std::unique_ptr<const Stencils>(
      StencilFactory::AppendLocalPointStencilTable(refiner, refined.get(), local));
}

class Collector {
public:
  Collector(int vertex_count, const Stencils& stencils) : vertex_count(vertex_count), stencils(stencils) {
    flat.local_points.offsets.push_back(0);
  }

  void add(const Far::PatchTable& patches, int array, int index) {
    const auto vertices = patches.GetPatchVertices(array, index);
    const Far::PatchParam param = patches.GetPatchParam(array, index);
    if (vertices.size() != 16) throw std::runtime_error("a patch is no bicubic B-spline");
    Patch points;
    for (int i = 0; i < 16; ++i) points[i] = vertices[i];
    extend(points, param.GetBoundary());
    for (const int point : points) append(flat.control_points, number(point));
    append(flat.quads, param.GetFaceId());
    const double size = param.GetParamFraction();
    append(flat.domains, param.GetU() * size, param.GetV() * size, size);
  }

  FlatPatches flat;

private:
  // Sides first from row to row, then across: a corner beyond two sides comes from a point that is there by then.
  void extend(Patch& points, int boundary) {
    for (int i = 0; i < 4; ++i) {
      if (boundary & bottom) points[i] = beyond(points[i + 4], points[i + 8]);
      if (boundary & top) points[i + 12] = beyond(points[i + 8], points[i + 4]);
    }
    for (int row = 0; row < 16; row += 4) {
      if (boundary & left) points[row] = beyond(points[row + 1], points[row + 2]);
      if (boundary & right) points[row + 3] = beyond(points[row + 2], points[row + 1]);
    }
  }

  // 2 a - b. Points past the border are negative: -1 - index into `rows`.
  int beyond(int a, int b) {
    const auto [known, is_new] = past_border.try_emplace({a, b}, -1 - static_cast<int>(rows.size()));
    if (is_new) {
      Row row;
      for (const auto& [vertex, weight] : row_of(a)) row[vertex] += 2.0 * weight;
      for (const auto& [vertex, weight] : row_of(b)) row[vertex] -= weight;
      rows.push_back(std::move(row));
    }
    return known->second;
  }

  Row row_of(int point) const {
    if (point < 0) return rows[-1 - point];
    if (point < vertex_count) return {{point, 1.0}};
    Row row;
    const auto stencil = stencils.GetStencil(point - vertex_count);
    for (int i = 0; i < stencil.GetSize(); ++i) row[stencil.GetVertexIndices()[i]] += stencil.GetWeights()[i];
    return row;
  }

  // The point's number in the result; the first call for a point writes its row.
  std::uint32_t number(int point) {
    if (point >= 0 && point < vertex_count) return static_cast<std::uint32_t>(point);
    const auto [known, is_new] = numbers.try_emplace(point, vertex_count + static_cast<int>(numbers.size()));
    if (is_new) write(row_of(point));
    return static_cast<std::uint32_t>(known->second);
  }

  void write(const Row& row) {
    for (const auto& [vertex, weight] : row) {
      if (weight == 0.0) continue;
      append(flat.local_points.indices, vertex);
      append(flat.local_points.weights, weight);
    }
    append(flat.local_points.offsets, flat.local_points.indices.size());
  }

  int vertex_count;
  const Stencils& stencils;
  std::map<std::pair<int, int>, int> past_border;
  std::vector<Row> rows;
  std::map<int, int> numbers;
};

}  // namespace

FlatPatches bspline_patches(std::uint32_t vertex_count, Indices cage, std::uint32_t isolation) {
  const Refiner refiner = make_refiner(vertex_count, cage);
  const auto options = patch_options(static_cast<int>(isolation));
  refiner->RefineAdaptive(options.GetRefineAdaptiveOptions());
  const std::unique_ptr<const Far::PatchTable> patches(Far::PatchTableFactory::Create(*refiner, options));
  const auto stencils = point_stencils(*refiner, *patches, static_cast<int>(isolation));
  Collector collector(static_cast<int>(vertex_count), *stencils);
  for (int array = 0; array < patches->GetNumPatchArrays(); ++array)
    for (int index = 0; index < patches->GetNumPatches(array); ++index) collector.add(*patches, array, index);
  return std::move(collector.flat);
}

}  // namespace softfold::opensubdiv
