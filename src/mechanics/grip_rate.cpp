#include "mechanics/grip_rate.hpp"

#include <algorithm>

#include "particles/field_names.hpp"

namespace stirsph {
namespace {

/// Of the running mean of the plastic rate: without it rates that set in and out from step to step make the torque of a
/// Couette flow scatter by 0.5 %.
constexpr double steps_of_memory = 10;
/// A held particle that hardly flows must not be hard without bound.
constexpr double largest_factor = 100;

}  // namespace

void GripRate::add_fields(ParticleSet& particles) {
  for (const FieldInfo* info :
       {&field::held, &field::plastic_rate_mean, &field::shared_plastic_rate, &field::rate_factor})
    particles.add(*info);
}

void GripRate::initialise(ParticleSet& particles) {
  const auto factor = particles[field::rate_factor];
  std::fill(factor.begin(), factor.end(), 1.0);
}

void GripRate::find_border(const ParticleSet& particles, const PairList& pairs) {
  const auto held = particles[field::held];
  border_.clear();
  starts_.assign(1, 0);
  opposite_.clear();
  for (std::size_t i = 0; i < particles.owned(); ++i) {
    for (const std::int32_t j : pairs.candidates(i / cluster_size))
      if (static_cast<std::size_t>(j) < particles.total() && held[j] != held[i]) opposite_.push_back(j);
    if (opposite_.size() == starts_.back()) continue;
    border_.push_back(static_cast<std::int32_t>(i));
    starts_.push_back(opposite_.size());
  }
  list_version_ = pairs.version();
}

void GripRate::update(ParticleSet& particles, const PairList& pairs) {
  if (list_version_ != pairs.version()) find_border(particles, pairs);
  const auto held = particles[field::held], mass = particles[field::mass], rate = particles[field::plastic_strain_rate];
  const auto mean = particles[field::plastic_rate_mean], shared = particles[field::shared_plastic_rate],
             factor = particles[field::rate_factor];
  for (std::size_t i = 0; i < particles.owned(); ++i) {
    mean[i] += (rate[i] - mean[i]) / steps_of_memory;
    factor[i] = 1;
  }
  std::vector<double> to_share(border_.size());
  std::visit(
      [&]<class K>(const K&) {
        for (std::size_t b = 0; b < border_.size(); ++b) {
          const auto i = static_cast<std::size_t>(border_[b]);
          const Vec3 x = particles.vector_at(field::position, i);
          double weights = 0, others = 0;
          for (std::size_t p = starts_[b]; p < starts_[b + 1]; ++p) {
            const auto j = static_cast<std::size_t>(opposite_[p]);
            const double q = norm(particles.vector_at(field::position, j) - x) / smoothing_;
            if (q >= K::support) continue;
            weights += mass[j] * K::value(q);
            others += mass[j] * K::value(q) * shared[j];
          }
          double felt = mean[i];
          if (held[i] != 0) {
            if (weights > 0) felt = others / weights;
            to_share[b] = weights > 0 ? mean[i] / weights : 0.0;
          } else {
            to_share[b] = felt = mean[i] + std::min(mean[i], others);
          }
          if (mean[i] > 0) factor[i] = std::clamp(felt / mean[i], 1.0, largest_factor);
        }
      },
      kernel_);
  for (std::size_t b = 0; b < border_.size(); ++b) shared[border_[b]] = to_share[b];
}

}  // namespace stirsph
