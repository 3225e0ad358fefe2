// A quad cage as OpenSubdiv sees it, refined around its extraordinary vertices.
#pragma once

#include <opensubdiv/far/topologyRefiner.h>

#include <memory>

#include "arrays.h"

namespace softfold::opensubdiv {

using Refiner = std::unique_ptr<OpenSubdiv::Far::TopologyRefiner>;

// How often a quad at an extraordinary vertex is halved before the rest of it is approximated.
constexpr int isolation_level = 6;

// Catmull-Clark; the border is a sharp crease with sharp corners. Throws if the cage is no oriented manifold.
Refiner make_refiner(std::uint32_t vertex_count, Indices cage);

}  // namespace softfold::opensubdiv
