/// Keeps particles, halo and pair list consistent: migration, storage order, halo plan and list are renewed together.
#pragma once

#include <span>
#include <vector>

#include "base/comm.hpp"
#include "neighbours/pair_list.hpp"
#include "parallel/decomposition.hpp"
#include "parallel/domain.hpp"
#include "parallel/halo_exchange.hpp"
#include "particles/inertia.hpp"
#include "particles/particle_set.hpp"

namespace stirsph {

/// How far particles have moved since the list was built, and how fast they move: largest values.
struct ListMotion {
  double deviation = 0;       ///< m, from the smooth motion
  double relative_speed = 0;  ///< m/s, to the smooth motion
  double displacement = 0;    ///< m
  double speed = 0;           ///< m/s
  double acceleration = 0;    ///< m/s2
  double extent = 0;          ///< m, distance from the origin
  bool finite = true;         ///< all velocities are numbers
};

class Neighbourhood {
 public:
  /// `skin` [m]: how much closer than at list build two particles may come before the list must be renewed.
  Neighbourhood(Comm comm, Domain domain, double skin);

  static void add_fields(ParticleSet& particles);

  /// Renews everything for the present positions. `support` [m]: largest kernel support. `costs`: of each owned
  /// particle in a step, what balance and ownership weigh; empty on all ranks for equal ones. Collective.
  void rebuild(ParticleSet& particles, double support, bool repartition, std::span<const double> costs = {});
  /// After a restart on the same number of ranks: the very list the checkpointed run was using, from the positions it
  /// was built with, so that sums continue bit for bit. Collective.
  void restore(ParticleSet& particles, const std::vector<double>& state);
  /// What `restore` needs besides the particles.
  std::vector<double> state() const { return {reach_, age_, compression_, distance_}; }

  /// The particles have moved for another dt [s].
  void advance(double dt) { age_ += dt; }
  /// Of this rank's particles. `inertia`: says whether they move along circles, which counts as an acceleration.
  ListMotion motion(const ParticleSet& particles, const Inertia& inertia) const;
  /// Whether no pair outside the list can come within the support until the end of a next step of dt [s], given the
  /// largest values over all ranks. Two particles a distance L > reach apart at the build are after the time t at least
  /// L sqrt(1 - 2 c t) - 2 w apart, c the compression of the smooth motion and w the largest deviation from it; beyond
  /// the distance for which c is known, L - 2 u with the largest displacement u.
  bool holds(const ListMotion& motion, double dt) const;

  const PairList& pairs() const { return pairs_; }
  const HaloExchange& halo() const { return halo_; }
  const Domain& domain() const { return domain_; }
  double skin() const { return skin_; }
  double reach() const { return reach_; }
  long rebuilds() const { return rebuilds_; }
  std::size_t bytes() const { return pairs_.bytes(); }

 private:
  Comm comm_;
  Domain domain_;
  double skin_;
  double reach_ = 0;
  double age_ = 0;          ///< s since the list was built
  double compression_ = 0;  ///< 1/s, of the smooth motion
  double distance_ = 0;     ///< m, up to which it holds
  Decomposition decomposition_;
  HaloExchange halo_;
  PairList pairs_;
  long rebuilds_ = 0;
};

}  // namespace stirsph
