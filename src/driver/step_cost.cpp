#include "driver/step_cost.hpp"

namespace stirsph {

std::vector<double> particle_costs(const Scene& scene, const ParticleSet& particles, const PairList& pairs,
                                   const Contact* contact, const std::vector<RigidBody>& rigids) {
  double each = step_cost.particle;
  if (contact) each += step_cost.contact_search * static_cast<double>(contact->pairs().size());
  if (scene.heat.mode == HeatScene::Mode::Conduction)
    each += step_cost.heat_row / static_cast<double>(scene.heat.every);
  std::vector<double> costs(particles.owned(), each);
  for (std::size_t i = 0; i < costs.size(); ++i)
    costs[i] += static_cast<double>(pairs.candidates(i / cluster_size).size());
  if (contact)
    for (const std::vector<std::int32_t>& near : contact->search(particles, rigids))
      for (const std::int32_t i : near) costs[i] += step_cost.contact_candidate;
  return costs;
}

double imbalance_of(const Comm& comm, double own) {
  const double mean = comm.sum(own) / comm.size();
  return mean > 0 ? comm.max(own) / mean : 1.0;
}

}  // namespace stirsph
