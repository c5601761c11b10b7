/// E10 of the verification catalogue: the thermal step against the mechanical step.
#include <gtest/gtest.h>

#include <cmath>

#include "support/heat_scene_run.hpp"

namespace stirsph::testing {
namespace {

class InBothSpaces : public ::testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Dimensions, InBothSpaces, ::testing::Values(2, 3),
                         [](const auto& space) { return std::to_string(space.param) + "D"; });

struct Sheared {
  double temperature, stress;
};

/// At shear 1, with the heat equation solved every so many of the 4000 mechanical steps.
Sheared sheared_block(int every, int dim) {
  const auto simulation = started(verification_scene("e10_staggering"),
                                  joined(joined(dim == 3 ? Overrides{} : Overrides{"space=plane_strain"},
                                                box("body.0.shape", {-2e-3, -2e-3, -2e-3}, {2e-3, 2e-3, 2e-3}, dim)),
                                         {"heat.every=" + std::to_string(every)}));
  run_to_end(*simulation);
  const std::vector<double> values = diagnose(*simulation).probes;
  return {values[0], values[1]};
}

TEST_P(InBothSpaces, FirstOrderInTheThermalStepE10) {
  const int dim = GetParam();
  const Sheared base = sheared_block(1, dim);
  std::printf("E10, %d-D, every step: rise %.4f K (58.418), shear stress %.4f MPa (149.118)\n", dim,
              base.temperature - 293.15, 1e-6 * base.stress);
  // C3 neglects the elastic part tau/G of the shear, G = 27.218 GPa, which makes no heat: 0.9 tau/(rho c_p) K of each
  // unit.
  const double expected = 58.418 - 0.9 * 149.118e6 / (2785 * 875) * 149.118e6 / 27.218e9;
  EXPECT_NEAR(base.temperature - 293.15, expected, 1e-3 * expected);
  double before = 0;
  for (const int every : {10, 100, 1000}) {
    const Sheared now = sheared_block(every, dim);
    // Solving every step is itself late by one: the error of n steps is proportional to n, its difference to n - 1.
    const double error = (now.temperature - base.temperature) * every / (every - 1);
    std::printf("E10, %d-D, every %d steps: temperature %+.4f K, shear stress %+.4f %%\n", dim, every, error,
                100 * (now.stress / base.stress - 1));
    if (before > 0) {
      std::printf("E10, %d-D: order %.3f\n", dim, std::log10(error / before));
      EXPECT_NEAR(std::log10(error / before), 1, 0.1);
    }
    before = error;
  }
}

}  // namespace
}  // namespace stirsph::testing
