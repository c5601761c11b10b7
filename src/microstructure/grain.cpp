#include "microstructure/grain.hpp"

#include <cmath>

namespace stirsph {
namespace {
constexpr double activation_energy = 135000;  // J/mol, paper section 2.2.5
constexpr double gas_constant = 8.314;        // J/mol/K, the value the constants were fitted with
constexpr double intercept = -0.1696, slope = 0.0153, exponent = -1.25;
}  // namespace

double log_zener_hollomon(double rate, double temperature) {
  return std::log(rate) + activation_energy / (gas_constant * temperature);
}

std::optional<double> recrystallised_grain_size(double rate, double temperature) {
  if (!(rate > 0) || !(temperature > 0)) return std::nullopt;
  const double value = intercept + slope * log_zener_hollomon(rate, temperature);
  if (value <= 0) return std::nullopt;
  return std::pow(value, 1 / exponent);
}

double hall_petch_hardness(double grain_size) { return 87 + 39 / std::sqrt(grain_size); }

}  // namespace stirsph
