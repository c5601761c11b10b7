/// What particles cost in a step: the weights of load balance.
#pragma once

#include <span>
#include <vector>

#include "base/comm.hpp"
#include "contact/contact.hpp"
#include "neighbours/pair_list.hpp"
#include "particles/particle_set.hpp"
#include "scene/scene.hpp"

namespace stirsph {

/// Costs in units of one candidate of a particle in both pair sweeps. They are counts times constants, not times:
/// seconds never repeat, and the same state must give the same partition. How they were measured: src/driver/README.md.
struct StepCost {
  double particle = 0;           ///< of each: material update, integration, vote
  double contact_search = 0;     ///< of each and contact pair, a step's share of the search
  double contact_candidate = 0;  ///< of each particle near the rigid body of a contact pair
  double heat_row = 0;           ///< of each in a heat solve
};
inline constexpr StepCost step_cost{7, 1.5, 17, 900};

/// Cost of each owned particle in a step: its cluster's candidates, itself, contact at these positions, heat.
std::vector<double> particle_costs(const Scene& scene, const ParticleSet& particles, const PairList& pairs,
                                   const Contact* contact, const std::vector<RigidBody>& rigids);
/// Most loaded rank over the mean; 1 when there is nothing to do. Collective.
double imbalance_of(const Comm& comm, double own);

}  // namespace stirsph
