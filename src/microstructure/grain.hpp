/// Grain size after dynamic recrystallisation and the hardness that follows from it (paper eqs 16-19; physics.md
/// section 6).
#pragma once

#include <optional>

namespace stirsph {

/// Zener-Hollomon parameter: ln Z = ln(rate) + Q/(R T). `rate` [1/s] > 0, `temperature` [K], Q = 135 kJ/mol.
double log_zener_hollomon(double rate, double temperature);

/// Grain diameter [micrometre] from d^-1.25 = -0.1696 + 0.0153 ln Z. Empty ("not recrystallised") for a rate of zero
/// and where the law has no value, ln Z <= 0.1696/0.0153. (The paper's delta^-m with m = -1.25 is a sign slip.)
std::optional<double> recrystallised_grain_size(double rate, double temperature);

/// Vickers hardness [HV] of a grain diameter [micrometre]: 87 + 39 d^-1/2 (eq. 19).
double hall_petch_hardness(double grain_size);

}  // namespace stirsph
