#include "opensubdiv/refiner.h"

#include <opensubdiv/far/topologyDescriptor.h>

#include <stdexcept>
#include <string>
#include <vector>

namespace softfold::opensubdiv {
namespace {

using namespace OpenSubdiv;
using Factory = Far::TopologyRefinerFactory<Far::TopologyDescriptor>;

Far::TopologyDescriptor describe(std::uint32_t vertex_count, Indices cage, const std::vector<int>& sizes,
                                 const std::vector<int>& indices) {
  Far::TopologyDescriptor descriptor;
  descriptor.numVertices = static_cast<int>(vertex_count);
  descriptor.numFaces = static_cast<int>(cage.size() / 4);
  descriptor.numVertsPerFace = sizes.data();
  descriptor.vertIndicesPerFace = indices.data();
  return descriptor;
}

void require_manifold(const Far::TopologyRefiner& refiner) {
  const Far::TopologyLevel base = refiner.GetLevel(0);
  for (int edge = 0; edge < base.GetNumEdges(); ++edge)
    if (base.IsEdgeNonManifold(edge)) {
      const auto ends = base.GetEdgeVertices(edge);
      throw std::runtime_error("quads at the edge between vertices " + std::to_string(ends[0]) + " and " +
                               std::to_string(ends[1]) + " do not make an oriented manifold");
    }
  for (int vertex = 0; vertex < base.GetNumVertices(); ++vertex)
    if (base.IsVertexNonManifold(vertex) && base.GetVertexFaces(vertex).size() > 0)
      throw std::runtime_error("quads touch only in vertex " + std::to_string(vertex));
}

}  // namespace

Refiner make_refiner(std::uint32_t vertex_count, Indices cage) {
  const std::vector<int> sizes(cage.size() / 4, 4);
  const std::vector<int> indices(cage.begin(), cage.end());
  Sdc::Options scheme;
  scheme.SetVtxBoundaryInterpolation(Sdc::Options::VTX_BOUNDARY_EDGE_AND_CORNER);
  Factory::Options options(Sdc::SCHEME_CATMARK, scheme);
  options.validateFullTopology = true;
  Refiner refiner(Factory::Create(describe(vertex_count, cage, sizes, indices), options));
  if (!refiner) throw std::runtime_error("the cage is not consistent");
  require_manifold(*refiner);
  return refiner;
}

}  // namespace softfold::opensubdiv
