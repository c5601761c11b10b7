#include "microstructure/grain.hpp"

#include <cmath>

namespace stirsph {
namespace {
constexpr double gas_constant = 8.314;  // J/mol/K, the value the paper's constants were fitted with
}

double log_zener_hollomon(const GrainLaw& law, double rate, double temperature) {
  return std::log(rate) + law.activation_energy / (gas_constant * temperature);
}

std::optional<double> recrystallised_grain_size(const GrainLaw& law, double rate, double temperature) {
  if (!(rate > 0) || !(temperature > 0)) return std::nullopt;
  const double value = law.intercept + law.slope * log_zener_hollomon(law, rate, temperature);
  if (value <= 0) return std::nullopt;
  return std::pow(value, 1 / law.exponent);
}

double hall_petch_hardness(const GrainLaw& law, double grain_size) {
  return law.hardness_intercept + law.hardness_slope / std::sqrt(grain_size);
}

}  // namespace stirsph
