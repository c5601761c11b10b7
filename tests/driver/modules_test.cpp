/// What a scene does not switch on takes no field.
#include <gtest/gtest.h>

#include "support/scene_run.hpp"

namespace stirsph::testing {
namespace {

const char* const head = R"(
[numerics]
spacing = "1 mm"
[time]
end = "1 s"
step = "1e-8 s"
[[material]]
name = "AL"
file = "al.toml"
[[body]]
name = "block"
material = "AL"
shape = { type = "box", low = ["0 mm", "0 mm", "0 mm"], high = ["6 mm", "6 mm", "6 mm"] }
temperature = "400 K"
[output]
checkpoint_wall_interval = "0 s"
)";

std::unique_ptr<Simulation> started_text(const std::string& text) {
  const std::string folder = std::string(STIRSPH_SOURCE_DIR) + "/tests/verification/materials";
  auto simulation = std::make_unique<Simulation>(Comm(), read_scene_text(text, folder));
  simulation->start();
  return simulation;
}

TEST(Modules, ElasticSceneHasNoHeatOrContactFields) {
  const auto simulation = started_text(head);
  const ParticleSet& particles = simulation->particles();
  for (const FieldInfo* info : {&field::heat_input, &field::conductivity, &field::matrix_row, &field::artificial_stress,
                                &field::corrected_stress, &field::initial_position, &field::sets})
    EXPECT_FALSE(particles.has(*info)) << info->name;
  EXPECT_EQ(simulation->contact(), nullptr);
}

TEST(Modules, HeatAloneHasNoMechanics) {
  const auto simulation = started_text("mechanics = false\n" + std::string(head) + "[heat]\nmode = \"conduction\"\n");
  const ParticleSet& particles = simulation->particles();
  for (const FieldInfo* info : {&field::velocity, &field::acceleration, &field::stress, &field::stress_deviator,
                                &field::equivalent_plastic_strain, &field::flow_stress})
    EXPECT_FALSE(particles.has(*info)) << info->name;
  EXPECT_EQ(simulation->mechanics(), nullptr);
  const double before = diagnose(*simulation).temperature_max;
  for (int n = 0; n < 3; ++n) simulation->step();
  EXPECT_NEAR(diagnose(*simulation).temperature_max, before, 1e-9);  // uniform and insulated: nothing may change
}

/// A body force is a physical weight and does work: free fall, with an inertia that is scaled by ten.
TEST(Modules, BodyForceIsWeightAndWork) {
  std::string text = head;
  text.insert(text.find("spacing = "), "density_scale = 10\n");
  const auto simulation = started_text(text + "[body_force]\nz = \"-1e5 m/s2\"\n");
  for (int n = 0; n < 20; ++n) simulation->step();
  const double t = simulation->clock().time, speed = 1e5 / 10 * t;
  for (std::size_t i = 0; i < simulation->particles().owned(); ++i)
    EXPECT_NEAR(simulation->particles().component(field::velocity, 2)[i], -speed, 1e-9 * speed);
  const Diagnostics d = diagnose(*simulation);
  EXPECT_GT(d.energy.kinetic, 0);
  EXPECT_NEAR(d.energy.external / d.energy.kinetic, 1, 0.06);  // work is counted half a step behind
}

/// Heat is the same whether solved every step or every fifth; friction heat of a lumped tool reaches the heat balance;
/// the density diffusion takes energy.
TEST(Modules, HeatOfManyStepsInOneSolve) {
  double fixed[2];
  for (int k = 0; k < 2; ++k) {
    const auto simulation =
        started(verification_scene("mini_tube"), {k == 0 ? "heat.every=1" : "heat.every=5", "time.most_steps=120"});
    double into_bodies = 0;
    run_to_end(*simulation, [&] {
      for (const ContactLoad& load : simulation->contact()->loads()) into_bodies += load.heat;
    });
    fixed[k] = simulation->heat_ledger().fixed;
    const Mechanics& mechanics = *simulation->mechanics();
    const double particles =
        simulation->comm().sum(mechanics.ledger().plastic_heat + simulation->contact()->ledger().friction_heat);
    const double source = simulation->heat_ledger().source, bodies = simulation->comm().sum(into_bodies);
    std::printf("mini tube: source %.8g J, particles %.8g J, bodies %.8g J, fixed %.6g J, diffusion %.3g J\n", source,
                particles, bodies, fixed[k], mechanics.ledger().diffusion);
    EXPECT_NEAR(source, particles + bodies, 1e-9 * source);
    EXPECT_GT(simulation->comm().sum(mechanics.ledger().diffusion), 0);
  }
  EXPECT_NEAR(fixed[1] / fixed[0], 1, 0.02);
}

}  // namespace
}  // namespace stirsph::testing
