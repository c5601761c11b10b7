/// D3 of the verification catalogue: a block that slides, stops and stays; and one that is pushed too gently to move.
#include <gtest/gtest.h>

#include <cmath>

#include "support/scene_run.hpp"

namespace stirsph::testing {
namespace {

enum Probe { Velocity, Position, Sole, Temperature };

TEST(SlidingBlock, StopsWhereCoulombSaysD3) {
  const auto simulation = started(verification_scene("d3_sliding_block"));
  const double mass = 2785 * 20e-3 * 20e-3 * 5e-3, start = diagnose(*simulation).probes[Position],
               cold = diagnose(*simulation).probes[Temperature];
  double after_stop = 0, settled_sole = 0, settled_time = 0;
  double early = 0, early_speed = 0, late = 0, late_speed = 0;
  run_to_end(*simulation, [&] {
    if (simulation->clock().step % 20 != 0) return;
    const Diagnostics now = diagnose(*simulation);
    const double t = simulation->clock().time;
    // The mean velocity falls on a straight line; the block's ringing hides the instant at which it reaches zero.
    if (early == 0 && now.probes[Velocity] < 9) {
      early = t;
      early_speed = now.probes[Velocity];
    }
    if (now.probes[Velocity] > 0.5) {
      late = t;
      late_speed = now.probes[Velocity];
    }
    if (t > 0.27e-3) after_stop = std::min(after_stop, now.probes[Velocity]);
    if (settled_time == 0 && t > 0.3e-3) {
      settled_time = t;
      settled_sole = now.probes[Sole];
    }
  });
  const Diagnostics end = diagnose(*simulation);
  const double stop_time = late + late_speed * (late - early) / (early_speed - late_speed);
  const double distance = end.probes[Position] - start, work = 0.5 * mass * 100;
  const double creep = (end.probes[Sole] - settled_sole) / (simulation->clock().time - settled_time);
  const double friction_heat = simulation->comm().sum(simulation->contact()->ledger().friction_heat);
  std::printf(
      "D3: stop %.5f ms, distance %.5f mm, friction heat %.5f J (eta m v^2/2 = %.5f), creep %.2g m/s, residual %.2g\n",
      1e3 * stop_time, 1e3 * distance, friction_heat, 0.9 * work, creep, end.energy.residual());
  EXPECT_NEAR(stop_time, 0.25641e-3, 0.005 * 0.25641e-3);
  EXPECT_NEAR(distance, 1.28205e-3, 0.005 * 1.28205e-3);
  EXPECT_NEAR(friction_heat, 0.9 * work, 0.005 * 0.9 * work);
  EXPECT_NEAR(mass * 875 * (end.probes[Temperature] - cold), friction_heat,
              1e-6 * friction_heat);  // it warms the block
  EXPECT_LT(std::abs(creep), 1e-6);
  EXPECT_GT(after_stop,
            -0.01);  // elastic ringing only: a reversed friction would push the block back at metres per second
  EXPECT_LT(std::abs(end.energy.residual()), 1e-3);
}

TEST(SlidingBlock, SticksBelowTheLimitD3) {
  // Pressed on slowly, then pushed with 0.9 mu N.
  const auto simulation = started(verification_scene("d3_sliding_block"),
                                  {"body.0.velocity.x=0 m/s", "body_force.z=-1e5*min(1,t/1e-4)",
                                   "body_force.x=0.351e5*max(0,min(1,(t-1e-4)/1e-4))", "time.end=0.35 ms"});
  double settled = 0, settled_time = 0;
  run_to_end(*simulation, [&] {
    if (settled_time > 0 || simulation->clock().time < 0.25e-3) return;
    settled_time = simulation->clock().time;
    settled = diagnose(*simulation).probes[Sole];
  });
  const double creep = (diagnose(*simulation).probes[Sole] - settled) / (simulation->clock().time - settled_time);
  std::printf("D3, pushed with 0.9 mu N: creep of the sole %.2g m/s\n", creep);
  EXPECT_LT(std::abs(creep), 1e-6);
}

/// Uniform pressure: the torque is 2/3 mu F R. The rings make it 0.6 % less at 22 rings over the radius, 0.35 % at 44.
TEST(TurningTool, TorqueOfUniformPressureD4) {
  const auto simulation = started(verification_scene("d4_plug_torque"));
  run_to_end(*simulation);
  const ContactLoad& load = simulation->contact()->loads()[0];
  const double force = simulation->comm().sum(load.normal_force), torque = -simulation->comm().sum(load.torque.z);
  const double exact = 2.0 / 3 * 0.39 * force * 11e-3;
  std::printf("D4 in rings: force %.0f N, torque over 2/3 mu F R %.4f\n", force, std::abs(torque) / exact);
  EXPECT_GT(force, 1e4);
  EXPECT_NEAR(std::abs(torque), exact, 0.01 * exact);
}

/// Acceleration of the layer under the plate, from its slip between 0.05 and 0.1 s, over what its inertia allows:
/// friction of its shear strength above, and below what the plain momentum sum passes on between the two outermost
/// layers, 0.8767 of it (see couette_test.cpp).
double drag(const std::vector<std::string>& overrides) {
  const auto run = started(verification_scene("dragged_layer"), overrides);
  const auto slip = [&] {
    const ContactLoad& load = run->contact()->loads()[0];
    return run->comm().sum(load.sliding_speed) / run->comm().sum(load.surface_speed);
  };
  double time = 0, before = 0;
  run_to_end(*run, [&] {
    if (time > 0 || run->clock().time < 0.05) return;
    time = run->clock().time;
    before = slip();
  });
  const double acceleration = 1.5 * (before - slip()) / (run->clock().time - time);
  const double layer = 0.75e-3 * 2785 * run->scene().numerics.density_scale;  // kg/m2
  return acceleration / ((1 - 0.8767) * 10e6 / std::sqrt(3.0) / layer);
}

/// Neither the pressure nor the direction to the rows of the lattice holds the layer back: particles that ride over
/// each other carry nothing.
TEST(DraggedLayer, FollowsThePlateAsItsInertiaAllows) {
  const double along = drag({}), across = drag({"rigid.0.motion.x=1.2 m/s", "rigid.0.motion.y=0.9 m/s"}),
               pressed = drag({"rigid.0.shape.point.2=-0.06 mm"});
  std::printf(
      "dragged layer: %.3f of the acceleration along the rows, %.3f at 37 degrees, %.3f under 3 times the pressure\n",
      along, across, pressed);
  for (const double ratio : {along, across, pressed}) EXPECT_NEAR(ratio, 0.8, 0.15);
}

}  // namespace
}  // namespace stirsph::testing
