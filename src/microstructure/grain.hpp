/// Grain size after dynamic recrystallisation and the hardness that follows from it (paper eqs 16-19; physics.md
/// section 6), with the constants of a material.
#pragma once

#include <optional>

#include "materials/grain_law.hpp"

namespace stirsph {

/// Zener-Hollomon parameter: ln Z = ln(rate) + Q/(R T). `rate` [1/s] > 0, `temperature` [K].
double log_zener_hollomon(const GrainLaw& law, double rate, double temperature);

/// Grain diameter [micrometre] from d^exponent = intercept + slope ln Z. Empty ("not recrystallised") for a rate of
/// zero and where the law has no value, intercept + slope ln Z <= 0.
std::optional<double> recrystallised_grain_size(const GrainLaw& law, double rate, double temperature);

/// Vickers hardness [HV] of a grain diameter [micrometre], Hall-Petch.
double hall_petch_hardness(const GrainLaw& law, double grain_size);

}  // namespace stirsph
