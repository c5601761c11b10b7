/// The closed-form return of the deviator against many small radial returns along the same strain path.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <random>

#include "mechanics/stress_point.hpp"
#include "particles/space.hpp"

namespace stirsph {
namespace {

using Deviator = std::array<double, 6>;

double size_of(const Deviator& a) { return std::sqrt(contraction<Cartesian3>(a.data(), a.data())); }
Deviator scaled(Deviator a, double factor) {
  for (double& c : a) c *= factor;
  return a;
}
Deviator random_direction(std::mt19937& random) {
  std::normal_distribution<double> normal;
  Deviator a;
  for (double& c : a) c = normal(random);
  const double mean = (a[0] + a[1] + a[2]) / 3;
  for (int c = 0; c < 3; ++c) a[c] -= mean;
  return scaled(a, 1 / size_of(a));
}

/// Perfectly plastic flow under a constant strain rate in n radial returns; error of order 1/n.
Deviator small_steps(const Deviator& start, const Deviator& increment, double radius, int n) {
  Deviator s = size_of(start) > radius ? scaled(start, radius / size_of(start)) : start;
  for (int k = 0; k < n; ++k) {
    for (int c = 0; c < 6; ++c) s[c] += increment[c] / n;
    if (const double size = size_of(s); size > radius) s = scaled(s, radius / size);
  }
  return s;
}

TEST(PlasticReturn, AsManySmallSteps) {
  constexpr double radius = 2.5;
  const double flow_stress = std::sqrt(1.5) * radius;
  std::mt19937 random(5);
  double worst = 0;
  int cases = 0;
  for (double old_size : {0.0, 0.2, 0.9, 1.0, 1.0 + 1e-12, 1.02})
    for (double step : {0.02, 0.3, 1.0, 2.5, 10.0, 2000.0})
      // From forward flow through tangential loading to exact reversal.
      for (double cosine : {1.0, 0.7, 0.0, -0.3, -0.95, -1.0}) {
        const Deviator direction = random_direction(random);
        Deviator other = random_direction(random);
        const double along = contraction<Cartesian3>(direction.data(), other.data());
        for (int c = 0; c < 6; ++c) other[c] -= along * direction[c];
        other = scaled(other, 1 / size_of(other));
        Deviator increment;
        for (int c = 0; c < 6; ++c)
          increment[c] =
              step * radius * (cosine * direction[c] + std::sqrt(std::max(0.0, 1 - cosine * cosine)) * other[c]);
        const Deviator start = scaled(direction, old_size * radius);
        double s[6];
        for (int c = 0; c < 6; ++c) s[c] = start[c] + increment[c];
        if (std::sqrt(contraction<Cartesian3>(s, s)) <= radius) continue;  // elastic
        double turned[6];
        std::copy(start.begin(), start.end(), turned);
        plastic_return<Cartesian3>(turned, flow_stress, s);
        // Extrapolated to n = infinity; what is left is of order 1/n^2, and the kink at first yield.
        constexpr int n = 20000;
        const Deviator once = small_steps(start, increment, radius, n),
                       twice = small_steps(start, increment, radius, 2 * n);
        double error = 0;
        for (int c = 0; c < 6; ++c) error = std::max(error, std::abs(s[c] - (2 * twice[c] - once[c])) / radius);
        // Extrapolation leaves 3e-10. Where the fallen flow stress alone makes the step plastic, the small steps stay
        // inside the surface, the code ends on it: no further apart than the fall.
        EXPECT_LT(error, size_of(twice) < radius * (1 - 1e-6) ? 0.02 : 1e-8)
            << "old size " << old_size << " step " << step << " cosine " << cosine;
        EXPECT_NEAR(std::sqrt(contraction<Cartesian3>(s, s)) / radius, 1, 1e-12);
        if (size_of(twice) > radius * (1 - 1e-6)) worst = std::max(worst, error);
        cases += 1;
      }
  std::printf("%d cases, largest difference %.1e of the radius\n", cases, worst);
  EXPECT_EQ(cases, 149);
}

TEST(PlasticReturn, WithoutStrainItScales) {
  // The flow stress fell (heating) and nothing moved.
  const double old[6] = {2, -1, -1, 0.5, 0, 0.2};
  double s[6];
  std::copy(old, old + 6, s);
  plastic_return<Cartesian3>(old, 1.0, s);
  EXPECT_NEAR(equivalent_stress<Cartesian3>(s), 1, 1e-14);
  for (int c = 0; c < 6; ++c) EXPECT_NEAR(s[c] * equivalent_stress<Cartesian3>(old), old[c], 1e-14);
}

}  // namespace
}  // namespace stirsph
