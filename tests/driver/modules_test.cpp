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

}  // namespace
}  // namespace stirsph::testing
