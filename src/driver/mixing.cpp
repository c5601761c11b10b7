#include "driver/mixing.hpp"

#include <array>
#include <cmath>
#include <limits>

#include "particles/field_names.hpp"

namespace stirsph {
namespace {

/// Kernel-smoothed shares of the components at one particle, and the variance that random mixing would leave in them.
struct Composition {
  std::vector<double> shares;
  double sum_of_squared_weights = 0;
};

template <class K>
Composition composition_at(const ParticleSet& particles, std::span<const std::int32_t> candidates,
                           std::span<const double> component, std::size_t components, std::size_t i) {
  const int dim = particles.layout().dim;
  std::array<const double*, 3> x{};
  for (int d = 0; d < dim; ++d) x[d] = particles.component(field::position, d).data();
  const auto mass = particles[field::mass];
  const double h = particles[field::smoothing_length][i];
  Composition result{std::vector<double>(components, 0.0)};
  double sum = 0;
  for (const std::int32_t j : candidates) {
    double r2 = 0;
    for (int d = 0; d < dim; ++d) r2 += (x[d][j] - x[d][i]) * (x[d][j] - x[d][i]);
    if (r2 >= K::support * K::support * h * h) continue;
    const double weight = mass[j] * K::value(std::sqrt(r2) / h);
    result.shares[static_cast<std::size_t>(component[j])] += weight;
    result.sum_of_squared_weights += weight * weight;
    sum += weight;
  }
  for (double& share : result.shares) share /= sum;
  result.sum_of_squared_weights /= sum * sum;
  return result;
}

}  // namespace

bool in_set(const ParticleSet& particles, int set, std::size_t i) {
  return set < 0 || (static_cast<std::uint64_t>(particles[field::sets][i]) >> set & 1);
}

double mixing_index(const Simulation& simulation, int set, bool by_body) {
  const ParticleSet& particles = simulation.particles();
  const PairList& pairs = simulation.neighbourhood().pairs();
  const std::span<const double> component = particles[by_body ? field::body : field::material];
  const Scene& scene = simulation.scene();
  const std::size_t components = by_body ? scene.bodies.size() : scene.materials.size();
  const auto mass = particles[field::mass];

  std::vector<double> amount(components, 0.0);
  for (std::size_t i = 0; i < particles.owned(); ++i)
    if (in_set(particles, set, i)) amount[static_cast<std::size_t>(component[i])] += mass[i];
  simulation.comm().sum_in_place(amount);
  double total = 0, separated = 0;
  for (const double part : amount) total += part;
  for (const double part : amount) separated += part / total * (1 - part / total);

  std::vector<double> sums(2, 0.0);  // mass times squared deviation, mass times squared weights
  std::visit(
      [&]<class K>(const K&) {
        for (std::size_t i = 0; i < particles.owned(); ++i) {
          if (!in_set(particles, set, i)) continue;
          const auto here = composition_at<K>(particles, pairs.candidates(i / cluster_size), component, components, i);
          for (std::size_t k = 0; k < components; ++k)
            sums[0] += mass[i] * std::pow(here.shares[k] - amount[k] / total, 2);
          sums[1] += mass[i] * here.sum_of_squared_weights;
        }
      },
      scene.numerics.kernel);
  simulation.comm().sum_in_place(sums);
  if (!(separated > 0)) return std::numeric_limits<double>::quiet_NaN();
  const double random = separated * sums[1] / total;
  return (separated - sums[0] / total) / (separated - random);
}

double angular_spread(const Simulation& simulation, int set) {
  const ParticleSet& particles = simulation.particles();
  std::vector<double> sums(3, 0.0);  // cosines, sines, particles
  for (std::size_t i = 0; i < particles.owned(); ++i) {
    if (!in_set(particles, set, i)) continue;
    const Vec3 x = particles.vector_at(field::position, i);
    const double radius = std::hypot(x.x, x.y);
    sums[2] += 1;
    if (radius == 0) continue;  // on the axis: at every angle alike
    sums[0] += x.x / radius;
    sums[1] += x.y / radius;
  }
  simulation.comm().sum_in_place(sums);
  if (sums[2] == 0) return std::numeric_limits<double>::quiet_NaN();
  return 1 - std::hypot(sums[0], sums[1]) / sums[2];
}

}  // namespace stirsph
