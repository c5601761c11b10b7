/// The SPH conduction operator: pair conductances between particles, as a symmetric graph of heat links.
///
/// Heat flow from j to i [W]: G_ij (T_j - T_i) with
///   G_ij = -2 V_i V_j k_ij s_ij W'(r_ij, h_ij) / (r_ij M),   k_ij = 2 k_i k_j / (k_i + k_j),  h_ij = (h_i + h_j) / 2,
/// the form of Brookshaw (1985) and Cleary and Monaghan (1999, J. Comput. Phys. 148, 227) in total heat per particle,
/// so that G_ij = G_ji >= 0: what leaves i arrives at j, and no temperature leaves the range of its neighbours. Two
/// factors are ours: M, the lattice factor (lattice_conduction_factor), and s_ij = (s_i + s_j) / 2, s_i = S_bulk /
/// sum_j V_j W_ij, which makes up for the links a particle at a surface lacks (README.md has the measured effect).
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "neighbours/pair_list.hpp"
#include "neighbours/smoothing_kernel.hpp"
#include "particles/field_info.hpp"
#include "particles/particle_set.hpp"

namespace stirsph {

/// What the operator needs besides the particles.
struct ConductionOperator {
  Kernel kernel;
  double lattice_factor = 1;  ///< M, see lattice_conduction_factor
  double bulk_sum = 1;        ///< S_bulk, the kernel sum inside a lattice; see lattice_kernel_sum
};

/// The heat links of one owned particle: local indices of its neighbours in rising order and the conductances [W/K].
struct HeatLinks {
  std::size_t particle;
  std::span<const std::int32_t> neighbours;
  std::span<const double> conductances;
};

/// Fills field::conduction_correction (s_i) of owned particles. `embedded`: sum of V W over neighbours that are not in
/// the particle set, per owned particle, or empty. Reads position, volume and smoothing length of halo copies.
void update_conduction_correction(ParticleSet& particles, const PairList& pairs, const ConductionOperator& op,
                                  std::span<const double> embedded = {});

/// Calls `visit` once per owned particle, in order, links to halo copies included, until it returns false. Reads
/// position, volume, smoothing length, conductivity and correction of halo copies.
void visit_heat_links(const ParticleSet& particles, const PairList& pairs, const ConductionOperator& op,
                      const std::function<bool(const HeatLinks&)>& visit);

/// Heat [W] that conduction brings to each owned particle at the present temperatures, halo copies up to date.
std::vector<double> conduction_power(const ParticleSet& particles, const PairList& pairs, const ConductionOperator& op);

}  // namespace stirsph
