#include "microstructure/grain_evolution.hpp"

#include <cmath>

#include "microstructure/grain.hpp"
#include "particles/field_names.hpp"

namespace stirsph {
namespace {
constexpr double micrometre = 1e-6;
}

void GrainEvolution::add_fields(ParticleSet& particles) {
  for (const FieldInfo* info :
       {&field::strain_at_window_start, &field::strain_rate_average, &field::grain_size, &field::recrystallised})
    particles.add(*info);
}

void GrainEvolution::initialise(ParticleSet& particles) const {
  const auto material = particles[field::material], strain = particles[field::equivalent_plastic_strain];
  auto grain = particles[field::grain_size], start = particles[field::strain_at_window_start];
  for (std::size_t i = 0; i < particles.owned(); ++i) {
    grain[i] = laws_[static_cast<std::size_t>(material[i])].initial_grain_size;
    start[i] = strain[i];
  }
}

void GrainEvolution::update(ParticleSet& particles, double before, double after) const {
  const double windows = std::floor(after / rule_.window) - std::floor(before / rule_.window);
  if (windows < 1) return;
  const double beyond = after - std::floor(after / rule_.window) * rule_.window;  // s, of the next window
  const auto material = particles[field::material], temperature = particles[field::temperature],
             strain = particles[field::equivalent_plastic_strain], rate_now = particles[field::plastic_strain_rate];
  auto start = particles[field::strain_at_window_start], average = particles[field::strain_rate_average],
       grain = particles[field::grain_size], recrystallised = particles[field::recrystallised];
  for (std::size_t i = 0; i < particles.owned(); ++i) {
    const double at_end = strain[i] - rate_now[i] * beyond;
    const double increment = std::max(at_end - start[i], 0.0);  // rounding may leave -1e-17 where nothing yields
    start[i] = at_end;
    average[i] = increment / (windows * rule_.window);
    if (average[i] < rule_.least_rate || temperature[i] < rule_.least_temperature) continue;
    const auto size =
        recrystallised_grain_size(laws_[static_cast<std::size_t>(material[i])], average[i], temperature[i]);
    if (!size) continue;  // the law has no value here: what was before stays
    const double old_share = rule_.renewal_strain > 0 ? std::exp(-increment / rule_.renewal_strain) : 0.0;
    grain[i] = old_share * grain[i] + (1 - old_share) * *size * micrometre;
    recrystallised[i] = 1;
  }
}

double hardness_of(const ParticleSet& particles, const std::vector<GrainLaw>& laws, std::size_t i) {
  return hall_petch_hardness(laws[static_cast<std::size_t>(particles[field::material][i])],
                             particles[field::grain_size][i] / micrometre);
}

}  // namespace stirsph
