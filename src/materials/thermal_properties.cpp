#include "materials/thermal_properties.hpp"

namespace stirsph {

double TemperaturePolynomial::integral(double reference, double temperature) const {
  // Inside the fitted range as a sum of (b^k - a^k)/k, with the factor (b - a) taken out: near-equal temperatures, the
  // common case of a small heat step, then lose no digits.
  const double a = std::clamp(reference, lowest, highest), b = std::clamp(temperature, lowest, highest);
  double mean = 0, quotient = 0, power = 1;  // quotient = (b^(k+1) - a^(k+1)) / (b - a), power = a^k
  for (std::size_t k = 0; k < coefficients.size(); ++k) {
    quotient = quotient * b + power;
    power *= a;
    mean += coefficients[k] * quotient / static_cast<double>(k + 1);
  }
  // Outside it the value is that of the nearer end.
  return mean * (b - a) + (*this)(temperature) * (temperature - b) - (*this)(reference) * (reference - a);
}

}  // namespace stirsph
