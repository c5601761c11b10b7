#include "mechanics/neighbourhood.hpp"

#include <algorithm>

#include "neighbours/cluster_order.hpp"
#include "particles/field_names.hpp"

namespace stirsph {

Neighbourhood::Neighbourhood(Comm comm, Domain domain, double skin)
    : comm_(comm), domain_(domain), skin_(skin), decomposition_(comm), halo_(comm) {}

void Neighbourhood::add_fields(ParticleSet& particles) {
  for (const FieldInfo* info : {&field::id, &field::body, &field::material, &field::mass, &field::position,
                                &field::position_at_list_build, &field::smoothing_length, &field::volume})
    particles.add(*info);
}

void Neighbourhood::rebuild(ParticleSet& particles, double support, bool repartition) {
  std::vector<double> weights;
  if (pairs_.clusters() == particles.clusters() && pairs_.clusters() > 0) {
    weights.resize(particles.owned());
    for (std::size_t i = 0; i < weights.size(); ++i)
      weights[i] = static_cast<double>(pairs_.candidates(i / cluster_size).size());
  }
  // All ranks must agree whether weights are candidate counts or plain ones.
  if (comm_.any(weights.empty() && particles.owned() > 0)) weights.clear();

  reach_ = support + skin_;
  const CellTable cells = decomposition_.redistribute(particles, domain_, reach_, repartition, weights);
  particles.reorder(cluster_order(particles));
  for (int d = 0; d < domain_.dim; ++d) {
    const auto from = particles.component(field::position, d);
    std::copy(from.begin(), from.end(), particles.component(field::position_at_list_build, d).begin());
  }
  halo_.build(particles, cells, reach_);
  pairs_.build(particles, reach_);
  rebuilds_ += 1;
}

void Neighbourhood::restore(ParticleSet& particles, double reach) {
  reach_ = reach;
  std::vector<AlignedVector> now(domain_.dim);
  for (int d = 0; d < domain_.dim; ++d) {
    auto x = particles.component(field::position, d);
    const auto built = particles.component(field::position_at_list_build, d);
    now[d].assign(x.begin(), x.begin() + particles.owned());
    std::copy(built.begin(), built.begin() + particles.owned(), x.begin());
  }
  const CellTable cells(comm_, particles, domain_, reach_);
  halo_.build(particles, cells, reach_);
  pairs_.build(particles, reach_);
  for (int d = 0; d < domain_.dim; ++d)
    std::copy(now[d].begin(), now[d].end(), particles.component(field::position, d).begin());
  halo_.exchange(particles, Halo::Kinematic);
}

double Neighbourhood::imbalance() const {
  const double own = static_cast<double>(pairs_.size());
  const double mean = comm_.sum(own) / comm_.size();
  return mean > 0 ? comm_.max(own) / mean : 1.0;
}

double Neighbourhood::largest_displacement_squared(const ParticleSet& particles) const {
  double largest = 0;
  const std::size_t n = particles.owned();
  std::array<const double*, 3> x{}, built{};
  for (int d = 0; d < domain_.dim; ++d) {
    x[d] = particles.component(field::position, d).data();
    built[d] = particles.component(field::position_at_list_build, d).data();
  }
  for (std::size_t i = 0; i < n; ++i) {
    double r2 = 0;
    for (int d = 0; d < domain_.dim; ++d) r2 += (x[d][i] - built[d][i]) * (x[d][i] - built[d][i]);
    largest = std::max(largest, r2);
  }
  return largest;
}

}  // namespace stirsph
