/// What scaled mass costs: F1 of the verification catalogue (F2 is in swirl_test.cpp, F3 in couette_test.cpp).
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "support/scene_run.hpp"

namespace stirsph::testing {
namespace {

constexpr double size = 10e-3, speed = 1, from = 1e-3;  // m: radius and height at the start; m/s; s

/// Means over the strains from 10 to 40 %.
struct Upsetting {
  double pressure = 0;  ///< Pa, on the moving plate
  double inertia = 0;   ///< Pa, (3/16) s rho v^2 R^2/H^2
};

Upsetting upset(double density_scale, std::vector<std::string> overrides) {
  overrides.push_back("numerics.density_scale=" + std::to_string(density_scale));
  const auto simulation = started(verification_scene("f1_upsetting"), overrides);
  const double density = simulation->scene().materials[0].density;
  Upsetting mean;
  long samples = 0;
  run_to_end(*simulation, [&] {
    const double time = simulation->clock().time;
    if (time < from) return;
    const double height = size - speed * time, radius_squared = size * size * size / height;
    mean.pressure += simulation->rigid_force(1).z / (M_PI * radius_squared);
    mean.inertia += 3.0 / 16 * density_scale * density * speed * speed * radius_squared / (height * height);
    samples += 1;
  });
  mean.pressure /= static_cast<double>(samples);
  mean.inertia /= static_cast<double>(samples);
  return mean;
}

/// Pressure gained over that foreseen, from one scaling to another: the flow stress drops out.
double gain(double low, double high, const std::vector<std::string>& overrides = {}) {
  const Upsetting light = upset(low, overrides), heavy = upset(high, overrides);
  const double ratio = (heavy.pressure - light.pressure) / (heavy.inertia - light.inertia);
  std::printf("F1: s %g to %g gains %.3f MPa, foreseen %.3f, ratio %.3f; pressure %.2f MPa\n", low, high,
              1e-6 * (heavy.pressure - light.pressure), 1e-6 * (heavy.inertia - light.inertia), ratio,
              1e-6 * light.pressure);
  return ratio;
}

/// Flow is not quite homogeneous, its kinetic energy too high; with the spacing that goes: ratios of 1.37, 1.15, 1.10
/// at 0.5, 0.25, 0.125 mm (s from 300, the last from 1000).
TEST(Upsetting, ScaledInertiaPressesOnThePlatesF1) { EXPECT_NEAR(gain(1e3, 3e4), 1, 0.2); }

/// 1.52 and 1.23 at 1 and 0.5 mm.
TEST(Upsetting, AlsoInThreeDimensionsF1) {
  EXPECT_NEAR(gain(3e3, 3e4, {"space=cartesian3", "numerics.spacing=1 mm"}), 1, 0.6);
}

}  // namespace
}  // namespace stirsph::testing
