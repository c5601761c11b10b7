/// Constants of the grain size and hardness laws of a material, as its data file gives them (`[microstructure]`).
#pragma once

namespace stirsph {

/// d^exponent = intercept + slope ln Z with Z = rate exp(Q/(R T)), d in micrometres and the rate in 1/s (paper eqs 16,
/// 17); HV = hardness_intercept + hardness_slope d^-1/2, again d in micrometres (eq. 19).
struct GrainLaw {
  double activation_energy = 0;  ///< Q, J/mol
  double intercept = 0, slope = 0, exponent = 0;
  double initial_grain_size = 0;  ///< m, before any recrystallisation
  double hardness_intercept = 0;  ///< HV
  double hardness_slope = 0;      ///< HV um^1/2
};

}  // namespace stirsph
