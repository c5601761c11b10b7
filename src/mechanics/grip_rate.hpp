/// Plastic strain rate at the face of a rigid grip.
///
/// The kernel spreads the jump of velocity between held and free metal over its support, and half of it falls on the
/// held side, where nothing flows: the strain rate next to a grip comes out up to twice too small, and metal whose
/// strength depends on it too soft. So the strength next to a grip feels, on top of a free particle's own rate, what
/// the held particles around it have of theirs, and held particles feel what the free ones opposite do:
///   free i: e_i + min(e_i, sum_k w_ik e_k m_k/m_i), held k: sum_i w_ik (rate of i), w_ik = m_i W_ik/sum_j m_j W_jk (j
///   free).
/// What flows on the held side, rate times mass, thus returns to the free one as a whole, and a linear profile of
/// velocity gets its true rate at the face. Strain and stress of held particles stay: only they resist the motion in
/// which neighbouring layers move against each other. A rate of the mirror image is never above a particle's own where
/// the rate falls with the distance from the face, hence the bound.
#pragma once

#include <cstdint>
#include <vector>

#include "neighbours/pair_list.hpp"
#include "neighbours/smoothing_kernel.hpp"
#include "particles/particle_set.hpp"

namespace stirsph {

class GripRate {
 public:
  /// smoothing [m].
  GripRate(const Kernel& kernel, double smoothing) : kernel_(kernel), smoothing_(smoothing) {}

  static void add_fields(ParticleSet& particles);
  static void initialise(ParticleSet& particles);
  /// From the plastic rates of this step the factor on those of the next (field rate_factor). Positions of halo copies
  /// must be current; what others share is that of the last step.
  void update(ParticleSet& particles, const PairList& pairs);
  std::size_t bytes() const {
    return (border_.capacity() + opposite_.capacity()) * sizeof(std::int32_t) +
           starts_.capacity() * sizeof(std::size_t);
  }

 private:
  void find_border(const ParticleSet& particles, const PairList& pairs);

  Kernel kernel_;
  double smoothing_;
  std::uint64_t list_version_ = 0;
  std::vector<std::int32_t> border_;    ///< owned particles with candidates of the other kind
  std::vector<std::size_t> starts_;     ///< where the candidates of each begin in `opposite_`
  std::vector<std::int32_t> opposite_;  ///< local indices of those candidates
};

}  // namespace stirsph
