/// A storage order in which every 8 consecutive particles are spatial neighbours.
#pragma once

#include <cstdint>
#include <vector>

#include "particles/particle_set.hpp"

namespace stirsph {

/// k-d order of the owned particles: recursive halving along the longest side, at multiples of the cluster size, so
/// that clusters are compact for lattices and for disordered particles alike and consecutive clusters are close in
/// space. The result depends on positions and ids only, not on the present order.
std::vector<std::int32_t> cluster_order(const ParticleSet& particles);

}  // namespace stirsph
