#include "opensubdiv/limit_stencils.h"

#include <opensubdiv/far/stencilTableFactory.h>

#include <memory>
#include <stdexcept>
#include <vector>

#include "opensubdiv/refiner.h"
#include "softfold-kernel/src/bridge/opensubdiv.rs.h"

namespace softfold::opensubdiv {
namespace {

using namespace OpenSubdiv;
using Factory = Far::LimitStencilTableFactoryReal<double>;
using Table = Far::LimitStencilTableReal<double>;

Factory::LocationArrayVec locations(Indices quads, const std::vector<double>& s, const std::vector<double>& t) {
  Factory::LocationArrayVec arrays;
  for (std::size_t i = 0; i < quads.size(); ++i) {
    if (i == 0 || quads[i] != quads[i - 1]) {
      arrays.emplace_back();
      arrays.back().ptexIdx = static_cast<int>(quads[i]);
      arrays.back().s = s.data() + i;
      arrays.back().t = t.data() + i;
    }
    ++arrays.back().numLocations;
  }
  return arrays;
}

void split(Numbers st, std::vector<double>& s, std::vector<double>& t) {
  for (std::size_t i = 0; i + 1 < st.size(); i += 2) {
    s.push_back(st[i]);
    t.push_back(st[i + 1]);
  }
}

FlatStencils no_stencils() {
  FlatStencils flat;
  flat.offsets.push_back(0);
  return flat;
}

FlatStencils flat_stencils(const Table& table) {
  FlatStencils flat = no_stencils();
  std::uint32_t offset = 0;
  for (const int size : table.GetSizes()) flat.offsets.push_back(offset += static_cast<std::uint32_t>(size));
  for (std::uint32_t i = 0; i < offset; ++i) {
    append(flat.indices, table.GetControlIndices()[i]);
    append(flat.weights, table.GetWeights()[i]);
    append(flat.weights_s, table.GetDuWeights()[i]);
    append(flat.weights_t, table.GetDvWeights()[i]);
  }
  return flat;
}

}  // namespace

FlatStencils limit_stencils(std::uint32_t vertex_count, Indices cage, Indices quads, Numbers st) {
  const Refiner refiner = make_refiner(vertex_count, cage);
  if (quads.empty()) return no_stencils();
  refiner->RefineAdaptive(Far::TopologyRefiner::AdaptiveOptions(isolation_level));
  std::vector<double> s, t;
  split(st, s, t);
  Factory::Options options;
  options.generate1stDerivatives = true;
  const std::unique_ptr<const Table> table(
      Factory::Create(*refiner, locations(quads, s, t), nullptr, nullptr, options));
  if (!table || table->GetNumStencils() != static_cast<int>(quads.size()))
    throw std::runtime_error("some samples lie in no patch");
  return flat_stencils(*table);
}

}  // namespace softfold::opensubdiv
