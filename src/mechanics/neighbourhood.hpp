/// Keeps particles, halo and pair list consistent: migration, storage order, halo plan and list are renewed together.
#pragma once

#include "base/comm.hpp"
#include "neighbours/pair_list.hpp"
#include "parallel/decomposition.hpp"
#include "parallel/domain.hpp"
#include "parallel/halo_exchange.hpp"
#include "particles/particle_set.hpp"

namespace stirsph {

class Neighbourhood {
 public:
  /// `skin` [m]: how much closer than at list build two particles may come before the list must be renewed.
  Neighbourhood(Comm comm, Domain domain, double skin);

  static void add_fields(ParticleSet& particles);

  /// Renews everything for the present positions. `support` [m]: largest kernel support. Collective.
  void rebuild(ParticleSet& particles, double support, bool repartition);
  /// After a restart on the same number of ranks: the very list the checkpointed run was using, from the positions it
  /// was built with, so that sums continue bit for bit. Collective.
  void restore(ParticleSet& particles, double reach);

  const PairList& pairs() const { return pairs_; }
  const HaloExchange& halo() const { return halo_; }
  const Domain& domain() const { return domain_; }
  double skin() const { return skin_; }
  double reach() const { return reach_; }
  long rebuilds() const { return rebuilds_; }
  /// Most loaded rank over the mean, from the number of candidate pairs; collective.
  double imbalance() const;
  /// Largest squared displacement since the list was built, on this rank [m2].
  double largest_displacement_squared(const ParticleSet& particles) const;
  std::size_t bytes() const { return pairs_.bytes(); }

 private:
  Comm comm_;
  Domain domain_;
  double skin_;
  double reach_ = 0;
  Decomposition decomposition_;
  HaloExchange halo_;
  PairList pairs_;
  long rebuilds_ = 0;
};

}  // namespace stirsph
