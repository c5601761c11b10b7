/// Grain size along a run: updated while a particle recrystallises, frozen afterwards.
#pragma once

#include <vector>

#include "materials/grain_law.hpp"
#include "particles/particle_set.hpp"

namespace stirsph {

/// When a particle counts as recrystallising, and over what its strain rate is averaged.
struct RecrystallisationRule {
  double window = 0;             ///< s of process time
  double least_rate = 0;         ///< 1/s, of the window's mean equivalent plastic strain rate
  double least_temperature = 0;  ///< K
  double renewal_strain = 0;     ///< strain over which new grains replace the old ones; 0: at once
};

class GrainEvolution {
 public:
  /// `laws`: by material index; those of materials without particles may be anything.
  GrainEvolution(const RecrystallisationRule& rule, std::vector<GrainLaw> laws) : rule_(rule), laws_(std::move(laws)) {}

  static void add_fields(ParticleSet& particles);
  /// The initial grain size of each particle's material, not recrystallised.
  void initialise(ParticleSet& particles) const;

  /// To be called once per step with the process times [s] before and after it. Nearly always returns at once: work is
  /// done only when a multiple of the window was passed. The strain at that instant is interpolated within the step,
  /// so that the mean rate is that of exactly one window whatever the steps are.
  void update(ParticleSet& particles, double before, double after) const;

 private:
  RecrystallisationRule rule_;
  std::vector<GrainLaw> laws_;
};

/// Vickers hardness [HV] of a particle. Throws Error(Internal) if the set has no grain sizes.
double hardness_of(const ParticleSet& particles, const std::vector<GrainLaw>& laws, std::size_t i);

}  // namespace stirsph
