/// The SPH conduction operator: pair conductances between particles, as a symmetric graph of heat links.
///
/// Heat flow from j to i [W]: G_ij (T_j - T_i) with
///   G_ij = -2 V_i V_j k_ij s_ij W'(r_ij, h_ij) / (r_ij M),   k_ij = 2 k_i k_j / (k_i + k_j),  h_ij = (h_i + h_j) / 2,
/// the form of Brookshaw (1985) and Cleary and Monaghan (1999, J. Comput. Phys. 148, 227) in total heat per particle,
/// so that G_ij = G_ji >= 0: what leaves i arrives at j, and no temperature leaves the range of its neighbours. Two
/// factors are ours: M, the lattice factor (lattice_conduction_factor), and s_ij = (s_i + s_j) / 2, s_i = S_bulk /
/// sum_j V_j W_ij, which makes up for the links a particle at a surface lacks (README.md has the measured effect).
///
/// In the axisymmetric space a particle is a ring with the section A = V/(2 pi r), and a link the ring between two
/// sections: G_ij = pi (r_i + r_j) times the formula of two dimensions with A for V. Sums of the kernel run over the
/// mirror images at the axis as well, so that the axis is no surface. Heat does not cross it: the links of i to the
/// image of j and of j to that of i have mean radii of opposite sign and cancel.
#pragma once

#include <cstdint>
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

/// The links of owned particles, in compressed form. Distances are computed once per arrangement of the particles; the
/// conductances follow from them for any conductivities.
class HeatGraph {
 public:
  /// Finds the links and fills field::conduction_correction (s_i) of owned particles. `embedded`: sum of V W over
  /// neighbours that are not in the particle set, per owned particle, or empty. Reads position, volume and smoothing
  /// length of halo copies. In the axisymmetric space copies on the far side of the axis are left out: mirror images
  /// are made here.
  void build(ParticleSet& particles, const PairList& pairs, const ConductionOperator& op,
             std::span<const double> embedded = {});

  std::size_t particles() const { return starts_.empty() ? 0 : starts_.size() - 1; }
  /// Local indices of the neighbours of an owned particle, rising.
  std::span<const std::int32_t> neighbours(std::size_t i) const {
    return {neighbours_.data() + starts_[i], neighbours_.data() + starts_[i + 1]};
  }
  /// G_ij / (k_ij s_ij) [m] of these links.
  std::span<const double> factors(std::size_t i) const {
    return {factors_.data() + starts_[i], factors_.data() + starts_[i + 1]};
  }
  std::size_t bytes() const;

 private:
  std::vector<std::size_t> starts_;
  std::vector<std::int32_t> neighbours_;
  std::vector<double> factors_;
};

/// What a link needs of its two particles, packed so that a neighbour costs one cache line.
class LinkEnds {
 public:
  /// Reads conductivity, correction and temperature, halo copies included.
  explicit LinkEnds(const ParticleSet& particles);

  /// The conductance [W/K] of a link. The same to the last bit seen from either end.
  double conductance(std::size_t i, std::size_t j, double factor) const {
    const End &a = ends_[i], &b = ends_[j];
    const double sum = a.conductivity + b.conductivity;
    return sum > 0 ? factor * (a.conductivity * b.conductivity / sum) * (a.correction + b.correction) : 0.0;
  }
  double temperature(std::size_t i) const { return ends_[i].temperature; }

 private:
  struct End {
    double conductivity, correction, temperature;
  };
  std::vector<End> ends_;
};

/// Heat [W] that conduction brings to each owned particle at the present temperatures, halo copies up to date.
std::vector<double> conduction_power(const ParticleSet& particles, const HeatGraph& graph);

}  // namespace stirsph
