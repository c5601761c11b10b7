/// Surface layers: their thickness under known deformations, and a patch test of a pressed block.
#include "contact/surface_layer.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "support/scene_run.hpp"

namespace stirsph::testing {
namespace {

constexpr double spacing = 1e-3;

/// One particle with the velocity gradient rows x y z.
struct OneParticle {
  OneParticle() {
    for (const FieldInfo* info : {&field::velocity_gradient, &field::plastic_strain_rate, &field::inverse_moment,
                                  &field::corrected_stress, &field::volume})
      particles.add(*info);
    SurfaceLayer::add_fields(particles);
    particles.resize_owned(1);
    layer.initialise(particles);
  }
  /// Deforms at a constant gradient [1/s] for a second, in many steps.
  void deform(const std::array<double, 9>& gradient, double plastic_rate = 0) {
    for (int c = 0; c < 9; ++c) particles.component(field::velocity_gradient, c)[0] = gradient[c];
    particles[field::plastic_strain_rate][0] = plastic_rate;
    constexpr int steps = 20000;
    for (int step = 0; step < steps; ++step) layer.advance(layer.arrays(particles), 1.0 / steps);
  }
  double thickness(const Vec3& n) { return layer.thickness(layer.arrays(particles), 0, n) / (0.5 * spacing); }

  SurfaceLayer layer{layout_of(Cartesian3{}), spacing};
  ParticleSet particles{layout_of(Cartesian3{})};
};

TEST(SurfaceLayer, IsSqueezedWithItsParticle) {
  OneParticle one;
  one.deform({-0.3, 0, 0, 0, 0.2, 0, 0, 0, 0.1});
  EXPECT_NEAR(one.thickness({1, 0, 0}), std::exp(-0.3), 1e-4);
  EXPECT_NEAR(one.thickness({0, 1, 0}), std::exp(0.2), 1e-4);
  const double slanted = std::sqrt((std::exp(-0.6) + std::exp(0.2)) / 2), half = std::numbers::sqrt2 / 2;
  EXPECT_NEAR(one.thickness({half, 0, half}), slanted, 1e-4);
  one.particles.component(field::velocity_gradient, 0)[0] = -2;
  EXPECT_NEAR(one.layer.opening(one.layer.arrays(one.particles), 0, {1, 0, 0}, 0.4e-3), -0.8e-3, 1e-15);
}

/// A layer that is sheared along its surface stays as thick as it is, a turned one keeps its thickness.
TEST(SurfaceLayer, ShearAlongTheSurfaceAndRotationLeaveItAlone) {
  OneParticle sheared;
  sheared.deform({0, 0.9, 0, 0, 0, 0, 0, 0, 0});
  EXPECT_NEAR(sheared.thickness({0, 1, 0}), 1, 1e-12);
  OneParticle turned;
  turned.deform({-0.2, 0, 0, 0, 0.2, 0, 0, 0, 0});
  const double quarter = std::numbers::pi / 2;
  turned.deform({0, -quarter, 0, quarter, 0, 0, 0, 0, 0});
  EXPECT_NEAR(turned.thickness({0, 1, 0}), std::exp(-0.2), 2e-4);
}

TEST(SurfaceLayer, ForgetsAsMetalFlowsAndHasLimits) {
  OneParticle one;
  one.deform({-0.4, 0, 0, 0, 0.2, 0, 0, 0, 0.2});
  const double before = one.thickness({1, 0, 0});
  one.deform({}, 3);
  // The deviation of b decays by e^-3, its volume stays.
  const double x = one.thickness({1, 0, 0}), y = one.thickness({0, 1, 0});
  EXPECT_NEAR(y * y - x * x, std::exp(-3) * (std::exp(0.4) - before * before), 0.01);
  EXPECT_NEAR(x * y * y, 1, 1e-4);
  one.deform({-9, 0, 0, 0, 9, 0, 0, 0, 0});
  EXPECT_EQ(one.thickness({1, 0, 0}), thinnest_layer);
  EXPECT_EQ(one.thickness({0, 1, 0}), thickest_layer);
}

const char* const pressed_block = R"toml(
space = "plane_strain"
[numerics]
spacing = "1 mm"
gradient_correction = "full"
viscosity_alpha = 0.5
[time]
end = "0.2 ms"
[[material]]
name = "AL"
file = "al_elastic_nu0.toml"
[[body]]
name = "block"
material = "AL"
shape = { type = "box", low = ["0 mm", "0 mm"], high = ["8 mm", "8 mm"] }
fill_margin = 0.45
[[rigid]]
name = "bottom"
shape = { type = "half_space", point = ["0 mm", "0 mm"], normal = [0, 1] }
[[rigid]]
name = "top"
shape = { type = "half_space", point = ["0 mm", "8 mm"], normal = [0, -1] }
motion = { type = "velocity", y = "-0.2*(1 - cos(2*pi*t/0.16e-3))*(t < 0.16e-3)" }   # 32 um
[[contact]]
rigid = "bottom"
penalty_scale = 0.5
damping = 0.2
[[contact]]
rigid = "top"
penalty_scale = 0.5
damping = 0.2
)toml";

/// Eight particles over the height: the force is E times the whole travel less the springs' depth, over the whole
/// height. With layers that do not deform it would be a quarter too large (twice dx/H). No work comes from nowhere.
TEST(SurfaceLayer, BlockBetweenPlatesHasItsWholeHeight) {
  if (Comm().size() > 1) GTEST_SKIP() << "force of one rank";
  Simulation run(Comm(),
                 read_scene_text(pressed_block, std::string(STIRSPH_SOURCE_DIR) + "/tests/verification/materials", {}));
  run.start();
  while (!run.finished()) run.step();
  const Diagnostics state = diagnose(run);
  const double depth = run.largest_penetration();
  const double strain = (32e-6 - 2 * depth) / 8e-3, force = 72.4e9 * strain * 8e-3;
  const double found = run.rigid_force(1).y;
  std::printf("pressed block of 8 x 8 particles: force %+.2f %%, energy residual %.1e, depth %.3f spacings\n",
              100 * (found / force - 1), state.energy.residual(), depth / spacing);
  EXPECT_NEAR(found, force, 0.03 * force);
  EXPECT_LT(std::abs(state.energy.residual()), 2e-3);
}

}  // namespace
}  // namespace stirsph::testing
