/// Guards of the scaled inertia against formulas, what happens at their limits, and the schedule of the density scale.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <functional>
#include <numbers>
#include <sstream>

#include "driver/run.hpp"
#include "io/checkpoint.hpp"
#include "support/scene_run.hpp"

namespace stirsph::testing {
namespace {

const std::string materials = std::string(STIRSPH_SOURCE_DIR) + "/tests/verification/materials";

std::string scratch(const Comm& comm, const std::string& name) {
  const std::string folder = std::string(STIRSPH_BINARY_DIR) + "/inertia_guards_test_" + std::to_string(comm.size());
  if (comm.is_root()) {
    std::filesystem::create_directories(folder);
    std::filesystem::remove_all(folder + "/" + name);
  }
  comm.barrier();
  return folder + "/" + name;
}

/// A block with a tool that turns above it.
const char* const block = R"toml(
[numerics]
spacing = "1 mm"
density_scale = 1e4
elastic_scale = 0.05
viscosity_alpha = 0.5
[time]
end = "1 s"
[[material]]
name = "AL"
file = "al.toml"
[[body]]
name = "block"
material = "AL"
shape = { type = "box", low = ["-7 mm", "-7 mm", "0 mm"], high = ["7 mm", "7 mm", "14 mm"] }
[[rigid]]
name = "tool"
shape = { type = "cylinder", base = ["0 mm", "0 mm", "15 mm"], radius = "4 mm", height = "10 mm" }
rotation = { rate = "1500 rpm" }
)toml";

/// A short bar between plates, elastic first, then plastic; round about z.
const char* const press = R"toml(
space = "axisymmetric"
[numerics]
spacing = "1 mm"
density_scale = 1e4
elastic_scale = 0.05
inertia_tolerance = 0.5
density_scale_before_flow = 8e4
[time]
end = "100 ms"
[[material]]
name = "AL"
file = "al.toml"
[[body]]
name = "bar"
material = "AL"
shape = { type = "cylinder", radius = "6 mm", height = "6 mm" }
fill_margin = 0.5
temperature = "600 K"
[[rigid]]
name = "punch"
shape = { type = "cylinder", base = ["0 mm", "0 mm", "6 mm"], radius = "10 mm", height = "5 mm" }
motion = { type = "velocity", z = "-20 mm/s" }
[[rigid]]
name = "plate"
shape = { type = "half_space", point = ["0 mm", "0 mm", "0 mm"], normal = [0, 0, 1] }
[[contact]]
rigid = "punch"
damping = 0.2
[[contact]]
rigid = "plate"
damping = 0.2
[limits]
guard_steps = 2
[output]
history_steps = 10
checkpoint_wall_interval = "0 s"
)toml";

std::unique_ptr<Simulation> started_text(const std::string& text, const std::vector<std::string>& overrides = {},
                                         Comm comm = Comm()) {
  auto simulation = std::make_unique<Simulation>(comm, read_scene_text(text, materials, overrides));
  simulation->start();
  return simulation;
}

/// The guards after all particles got the velocity and, where `flows`, a plastic strain rate.
InertiaGuards guards_of(Simulation& simulation, const std::function<Vec3(const Vec3&)>& velocity,
                        const std::function<bool(const Vec3&)>& flows) {
  ParticleSet& particles = simulation.particles();
  for (std::size_t i = 0; i < particles.owned(); ++i) {
    const Vec3 x = particles.vector_at(field::position, i), v = velocity(x);
    for (int d = 0; d < 3; ++d) particles.component(field::velocity, d)[i] = v[d];
    particles[field::plastic_strain_rate][i] = flows(x) ? 1.0 : 0.0;
  }
  simulation.neighbourhood().halo().exchange(particles, Halo::Kinematic);
  simulation.mechanics()->update_acceleration(particles, simulation.neighbourhood().pairs(), 0.0);
  InertiaGuards guards(simulation.scene());
  guards.look(simulation);
  return guards;
}

bool inside(const Vec3& x) {  // more than the support of the kernel from every face
  return std::abs(x.x) < 4.4e-3 && std::abs(x.y) < 4.4e-3 && std::abs(x.z - 7e-3) < 4.4e-3;
}

bool far_inside(const Vec3& x) {  // the same of a smoothing length of two spacings
  return std::abs(x.x) < 2.4e-3 && std::abs(x.y) < 2.4e-3 && std::abs(x.z - 7e-3) < 2.4e-3;
}

TEST(InertiaGuards, TranslationHasInertiaAndNoViscousStress) {
  const auto simulation = started_text(block);
  const double density = 2785e4, strength = simulation->comm().max(simulation->particles()[field::flow_stress][0]);
  // A fast particle that does not flow must not count.
  const auto guards = guards_of(
      *simulation,
      [](const Vec3& x) {
        return inside(x) ? Vec3{0.3, 0, 0.4} : Vec3{0, 90, 0};
      },
      [](const Vec3& x) { return std::abs(x.x) < 1e-3 && std::abs(x.y) < 1e-3 && std::abs(x.z - 7e-3) < 1e-3; });
  EXPECT_NEAR(guards.measured(Guard::Inertia) / (density * 0.25 / strength), 1, 1e-9);
  EXPECT_LT(guards.measured(Guard::Viscous), 1e-12);
  EXPECT_EQ(guards.value(Guard::Inertia), 0) << "no plastic work was done: metal does not flow";
}

TEST(InertiaGuards, ShearOfKnownRate) {
  for (const char* kernel : {"cubic", "wendland_c2"}) {
    const auto simulation = started_text(block, {std::string("numerics.kernel=") + kernel, "numerics.h_over_dx=2"});
    const double rate = 30;
    const auto guards = guards_of(
        *simulation,
        [&](const Vec3& x) {
          return Vec3{rate * x.z, 0, 0};
        },
        far_inside);
    const double strength = simulation->comm().max(simulation->particles()[field::flow_stress][0]);
    const double sound = simulation->mechanics()->wave_speed();
    const double expected = 0.5 * 2785e4 * sound * 2e-3 * rate / std::numbers::sqrt3 / strength;
    std::printf("%s: viscous guard %.5f, of a shear of that rate %.5f\n", kernel, guards.measured(Guard::Viscous),
                expected);
    // Lattice and softening take 1 %, pairs on the edge of the chosen particles up to 4 %.
    EXPECT_NEAR(guards.measured(Guard::Viscous) / expected, 1, 0.06);
  }
}

TEST(InertiaGuards, RimTravelAndSpinUp) {
  const auto simulation = started_text(block, {"body.0.velocity.x=0.2 m/s"});
  simulation->step();
  const auto guards = guards_of(
      *simulation, [](const Vec3&) { return Vec3{}; }, inside);
  const double omega = 1500.0 / 60 * 2 * std::numbers::pi, rim = omega * 4e-3;
  // The metal is slower than the rim: its own speed counts.
  const double fastest = simulation->largest_speed();
  EXPECT_GT(fastest, 0.1);
  EXPECT_LT(fastest, rim);
  EXPECT_NEAR(guards.measured(Guard::RimTravel) / (fastest * simulation->clock().dt / 1e-3), 1, 1e-9);
  const double strength = simulation->comm().max(simulation->particles()[field::flow_stress][0]);
  const double spin_up = 2785e4 * 1e-3 * rim / (strength / std::numbers::sqrt3);
  EXPECT_NEAR(guards.measured(Guard::SpinUp) / (spin_up * omega / (2 * std::numbers::pi)), 1, 1e-9);
}

std::string content(const std::string& path) {
  std::ifstream file(path);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

TEST(InertiaGuards, WarnOnceOrStopWithTheStateSaved) {
  const Comm comm;
  for (const char* action : {"warn", "stop"}) {
    RunOptions options;
    options.folder = scratch(comm, action);
    options.quiet = true;
    const Scene scene =
        read_scene_text(press, materials, {"limits.guard_inertia=1e-9", std::string("limits.guard_action=") + action});
    if (action == std::string("warn")) {
      EXPECT_EQ(run_scene(comm, scene, options), ExitCode::Finished);
    } else {
      try {
        run_scene(comm, scene, options);
        FAIL() << "it should have stopped";
      } catch (const Error& error) {
        EXPECT_EQ(error.code(), ExitCode::BlowUp);
        EXPECT_NE(std::string(error.what()).find("limits.guard_inertia = 1e-09"), std::string::npos) << error.what();
      }
    }
    comm.barrier();
    EXPECT_EQ(std::filesystem::exists(options.folder + "/failed_state.h5"), action == std::string("stop"));
    if (action != std::string("warn")) continue;
    const std::string log = content(options.folder + "/run.log");
    const auto first = log.find("above limits.guard_inertia");
    ASSERT_NE(first, std::string::npos);
    EXPECT_EQ(log.find("above limits.guard_inertia", first + 1), std::string::npos) << "said once";
    EXPECT_NE(log.find("density scale 1e+04 -> 2e+04"), std::string::npos);
    EXPECT_NE(content(options.folder + "/summary.json").find("\"density_scale_changes\": 4"), std::string::npos);
  }
}

TEST(ScalingSchedule, RaisesInElasticMetalAndLowersAtOnset) {
  const auto simulation = started_text(press);
  double largest = 0, looks_with_flow = 0, last_scale = 1e4, last_step = simulation->clock().next_dt;
  run_to_end(*simulation, [&] {
    const double scale = simulation->mechanics()->inertia().scale;
    EXPECT_EQ(scale, simulation->schedule()->scale());
    const double step = simulation->clock().next_dt;
    if (scale != last_scale) {
      // dt = C h/(c/sqrt(s) + |v|), and the speed is small.
      EXPECT_NEAR(std::log(step / last_step) / std::log(scale / last_scale), 0.5, 0.02);
    }
    last_scale = scale;
    last_step = step;
    largest = std::max(largest, scale);
    if (simulation->guards()->flows()) {
      looks_with_flow += 1;
      EXPECT_EQ(scale, 1e4) << "at t = " << simulation->clock().time;
    }
  });
  EXPECT_EQ(largest, 8e4);
  EXPECT_GT(looks_with_flow, 50);
  EXPECT_EQ(simulation->schedule()->changes(), 4) << "up, up, up, and down at once";
  EXPECT_LT(std::abs(diagnose(*simulation).energy.residual()), 0.01);
}

/// Energy that comes in with mass is booked: waves in a free bar, whose scaling is changed up and down on the way.
TEST(ScalingSchedule, ChangesKeepVelocitiesAndAreBooked) {
  const char* const bar = R"toml(
[numerics]
spacing = "1 mm"
viscosity_alpha = 0
gradient_correction = "full"
density_scale = 100
[time]
end = "1 s"
cfl = 0.2
[[material]]
name = "AL"
file = "al_elastic.toml"
[[body]]
name = "bar"
material = "AL"
shape = { type = "box", low = ["0 mm", "0 mm", "0 mm"], high = ["20 mm", "4 mm", "4 mm"] }
velocity = { x = "cos(pi*x/0.02)" }
)toml";
  const auto simulation = started_text(bar);
  double rescaling = 0;
  for (int n = 0; n < 300; ++n) {
    simulation->step();
    if (n % 100 != 50) continue;
    const double kinetic = diagnose(*simulation).energy.kinetic, factor = n == 150 ? 0.25 : 4;
    const std::vector<double> before = gathered(*simulation, field::velocity);
    simulation->change_density_scale(factor * simulation->mechanics()->inertia().scale);
    EXPECT_EQ(gathered(*simulation, field::velocity), before);
    const EnergyBalance after = diagnose(*simulation).energy;
    EXPECT_NEAR(after.kinetic / (factor * kinetic), 1, 1e-12);
    rescaling += (factor - 1) * kinetic;
    EXPECT_NEAR(after.rescaling / rescaling, 1, 1e-9);
  }
  const EnergyBalance end = diagnose(*simulation).energy;
  std::printf("residual %.2e; rescaling %.3g J of %.3g J at the start\n", end.residual(), end.rescaling,
              end.initial_kinetic);
  EXPECT_GT(std::abs(end.rescaling), 0.1 * end.initial_kinetic);
  EXPECT_LT(std::abs(end.residual()), 5e-3);
}

TEST(ScalingSchedule, RestartInTheMiddleGoesOnBitForBit) {
  const Comm comm;
  const std::string folder = scratch(comm, "restart");
  if (comm.is_root()) std::filesystem::create_directories(folder);
  comm.barrier();
  const std::string file = folder + "/half.h5";
  const auto whole = started_text(press);
  bool saved = false;
  run_to_end(*whole, [&] {
    if (saved || whole->mechanics()->inertia().scale < 4e4) return;
    saved = true;
    write_checkpoint(comm, file, whole->particles(), whole->named_state());
  });
  ASSERT_TRUE(saved);
  Simulation half(comm, read_scene_text(press, materials));
  half.resume(file);
  EXPECT_EQ(half.mechanics()->inertia().scale, 4e4);
  run_to_end(half);
  EXPECT_EQ(half.clock().step, whole->clock().step);
  EXPECT_EQ(half.schedule()->changes(), 4);
  for (int d = 0; d < 2; ++d) EXPECT_EQ(gathered(half, field::position, d), gathered(*whole, field::position, d));
  EXPECT_EQ(gathered(half, field::equivalent_plastic_strain), gathered(*whole, field::equivalent_plastic_strain));
  EXPECT_EQ(half.guards()->state(), whole->guards()->state());
  EXPECT_NEAR(diagnose(half).energy.rescaling, diagnose(*whole).energy.rescaling, 0);
}

TEST(ScalingSchedule, SameOnAnyRankCount) {
  const auto together = started_text(press), alone = started_text(press, {}, Comm(MPI_COMM_SELF));
  std::vector<std::int64_t> changes[2];
  int k = 0;
  for (Simulation* simulation : {together.get(), alone.get()}) {
    double last = 1e4;
    run_to_end(*simulation, [&] {
      const double scale = simulation->mechanics()->inertia().scale;
      if (scale != last) changes[k].push_back(simulation->clock().step);
      last = scale;
    });
    ++k;
  }
  EXPECT_EQ(changes[0].size(), 4u);
  EXPECT_EQ(changes[0], changes[1]);
  const auto a = gathered(*together, field::position, 1), b = gathered(*alone, field::position, 1);
  for (std::size_t i = 0; i < a.size(); ++i) EXPECT_NEAR(a[i], b[i], 1e-9 * 6e-3);
}

/// A force controller is renewed for the mass of now, and its tool does not search contact with a raised scaling.
TEST(ScalingSchedule, WaitsForContactUnderForce) {
  std::string text = press;
  text.replace(text.find("{ type = \"velocity\", z = \"-20 mm/s\" }"), 37,
               "{ type = \"force\", preload = \"4 kN\", approach_time = \"2 ms\", ramp_rate = \"1 kN/s\", target = "
               "\"5 kN\", velocity_limit = \"20 mm/s\" }");
  text.replace(text.find("base = [\"0 mm\", \"0 mm\", \"6 mm\"]"), 31, "base = [\"0 mm\", \"0 mm\", \"6.1 mm\"]");
  const auto simulation = started_text(text, {"time.end=200 ms"});
  double searched = 0, slowest = 1;
  const double impact = simulation->motions()[0].force_control()->impact_force();
  run_to_end(*simulation, [&] {
    const ForceControl& control = *simulation->motions()[0].force_control();
    slowest = std::min(slowest, control.approach_speed());
    if (control.phase() != ForceControl::Phase::Search) return;
    searched += 1;
    EXPECT_EQ(simulation->mechanics()->inertia().scale, 1e4);
  });
  EXPECT_GT(searched, 50);
  EXPECT_EQ(simulation->schedule()->largest_so_far(), 8e4);
  EXPECT_NEAR(simulation->motions()[0].force_control()->error(), 0, 0.03);
  // The same share of the preload as impact force, now at a heavier mass: a lower speed.
  EXPECT_LE(simulation->motions()[0].force_control()->impact_force(), impact * 3);
  EXPECT_LT(slowest, 20e-3);
}

TEST(ScalingSchedule, RefusesWhatCannotWork) {
  const auto refusal = [](const std::vector<std::string>& overrides) {
    try {
      read_scene_text(press, materials, overrides);
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_EQ(refusal({}), "");
  EXPECT_NE(refusal({"numerics.inertia_tolerance=0"}).find("density_scale_before_flow"), std::string::npos);
  EXPECT_NE(refusal({"time.step=1 us"}).find("time.step"), std::string::npos);
  EXPECT_NE(refusal({"limits.guard_steps=0"}).find("guard_steps"), std::string::npos);
  EXPECT_NE(refusal({"numerics.density_scale_before_flow=100"}).find("density_scale or more"), std::string::npos);
}

}  // namespace
}  // namespace stirsph::testing
