/// Thermal conductivity and specific heat as polynomials of the temperature in kelvin (paper, table 2).
#pragma once

#include <algorithm>
#include <vector>

namespace stirsph {

/// c0 + c1 T + c2 T^2 + ..., T in K, held constant outside [lowest, highest] where the fit has no meaning.
struct TemperaturePolynomial {
  std::vector<double> coefficients;
  double lowest = 0, highest = 1e9;  ///< K

  double operator()(double temperature) const {
    const double t = std::clamp(temperature, lowest, highest);
    double value = 0;
    for (std::size_t k = coefficients.size(); k-- > 0;) value = value * t + coefficients[k];
    return value;
  }
  /// Integral from `reference` to `temperature`; exact also where the value is held.
  double integral(double reference, double temperature) const;
  bool constant() const { return coefficients.size() <= 1; }
};

struct ThermalProperties {
  TemperaturePolynomial conductivity;   ///< W/m/K
  TemperaturePolynomial specific_heat;  ///< J/kg/K
};

}  // namespace stirsph
