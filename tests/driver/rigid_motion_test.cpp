/// Tool control: displacement table, force programme and its controller, rotation.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "scene/rigid_motion.hpp"

namespace stirsph {
namespace {

MotionScene programme() {
  MotionScene scene;
  scene.kind = MotionScene::Kind::Force;
  scene.direction = {0, 0, -1};
  scene.preload = 5e3;
  scene.approach_time = 0.2;
  scene.dwell = 5;
  scene.ramp_rate = 500;
  scene.target = 12e3;
  scene.velocity_limit = 1e-3;
  return scene;
}

TEST(ForceProgramme, IsThePapers) {
  // physics.md section 1: 5 kN, 5 s dwell, then 0.5 kN/s up to 12 kN, held.
  const RigidMotion motion(programme(), {1e7, 100});
  EXPECT_DOUBLE_EQ(motion.target_force(0), 0);
  EXPECT_DOUBLE_EQ(motion.target_force(0.1), 2500);
  EXPECT_DOUBLE_EQ(motion.target_force(5), 5000);
  EXPECT_DOUBLE_EQ(motion.target_force(7), 6000);
  EXPECT_DOUBLE_EQ(motion.target_force(19), 12000);
  EXPECT_DOUBLE_EQ(motion.target_force(40), 12000);
}

/// A tool on a spring: the controller must bring the force to the programme and hold it there.
TEST(ForceControl, HoldsTheForceOfASpring) {
  MotionScene scene = programme();
  scene.dwell = 1;
  scene.target = 6e3;
  const double stiffness = 1e7, dt = 1e-4;
  RigidMotion motion(scene, {stiffness, 500});
  RigidPose pose = motion.initial_pose();
  double overshoot = 0;
  for (double t = 0; t < 4; t += dt) {
    const double force = std::max(0.0, -pose.translation.z * stiffness);
    motion.advance(pose, t, dt, {0, 0, force});
    ASSERT_LE(std::abs(pose.velocity.z), scene.velocity_limit * (1 + 1e-12));
    if (t > 0.5 && t < 1) {
      EXPECT_NEAR(force, 5e3, 0.02 * 5e3);
    }
    overshoot = std::max(overshoot, force - motion.target_force(t));
  }
  EXPECT_NEAR(-pose.translation.z * stiffness, 6e3, 10);
  EXPECT_LT(overshoot, 0.02 * 6e3);
}

/// No contact for a while: the velocity limit holds, and the integral has not wound up when contact comes.
TEST(ForceControl, DoesNotWindUpBeforeContact) {
  MotionScene scene = programme();
  scene.dwell = 100;
  const double stiffness = 1e7, dt = 1e-4, gap = 0.5e-3;
  RigidMotion motion(scene, {stiffness, 500});
  RigidPose pose = motion.initial_pose();
  double largest = 0;
  for (double t = 0; t < 3; t += dt) {
    const double force = std::max(0.0, (-pose.translation.z - gap) * stiffness);
    largest = std::max(largest, force);
    motion.advance(pose, t, dt, {0, 0, force});
    if (t > 0.05 && t < 0.4) {
      EXPECT_TRUE(motion.at_velocity_limit());
    }
  }
  EXPECT_LT(largest, 1.05 * 5e3);
  EXPECT_NEAR((-pose.translation.z - gap) * stiffness, 5e3, 10);
}

TEST(ForceControl, ContinuesFromItsSavedState) {
  RigidMotion straight(programme(), {1e7, 500}), second(programme(), {1e7, 500});
  RigidPose a = straight.initial_pose();
  const auto force = [](const RigidPose& pose) { return Vec3{0, 0, std::max(0.0, -pose.translation.z * 1e7)}; };
  for (int n = 0; n < 1000; ++n) straight.advance(a, n * 1e-4, 1e-4, force(a));
  second.restore(straight.state());
  RigidPose b = a;
  for (int n = 1000; n < 2000; ++n) {
    straight.advance(a, n * 1e-4, 1e-4, force(a));
    second.advance(b, n * 1e-4, 1e-4, force(b));
  }
  EXPECT_EQ(a.translation.z, b.translation.z);
}

TEST(DisplacementTable, IsFollowedExactly) {
  MotionScene scene;
  scene.kind = MotionScene::Kind::Displacement;
  scene.direction = {0, 0, -1};
  scene.table = TabulatedCurve({0, 1, 2}, {0, 1e-3, 4e-3});
  RigidMotion motion(scene, {});
  RigidPose pose = motion.initial_pose();
  double t = 0;
  for (double dt : {0.3, 0.5, 0.4, 0.6}) {
    const double before = pose.translation.z;
    motion.advance(pose, t, dt, {});
    t += dt;
    EXPECT_NEAR(pose.translation.z, -scene.table->value(t), 1e-15);
    EXPECT_NEAR(pose.velocity.z, (pose.translation.z - before) / dt, 1e-15);
  }
}

TEST(Rotation, TurnsByTheRateAndCarriesThePointsOfTheBody) {
  MotionScene scene;
  scene.centre = {1e-3, 0, 0};
  scene.rotation = input::Expression(2 * std::numbers::pi * 25);  // 1500 rpm
  RigidMotion motion(scene, {});
  RigidPose pose = motion.initial_pose();
  for (int n = 0; n < 100; ++n) motion.advance(pose, n * 1e-3, 1e-3, {});
  EXPECT_NEAR(pose.angle, 2 * std::numbers::pi * 2.5, 1e-9);
  // The rim of an 11 mm tool at 1500 rpm moves at 1.728 m/s.
  EXPECT_NEAR(norm(pose.velocity_at({12e-3, 0, 5e-3})), 1.728, 1e-3);
}

TEST(Rotation, FollowsATable) {
  MotionScene scene;
  scene.rotation = input::Expression(0.0);
  scene.rotation_table = TabulatedCurve({0, 1}, {0, 100});
  RigidMotion motion(scene, {});
  RigidPose pose = motion.initial_pose();
  for (int n = 0; n < 200; ++n) motion.advance(pose, n * 0.01, 0.01, {});
  EXPECT_NEAR(pose.angle, 50 + 100, 1e-9);  // ramp, then held; the midpoint rule is exact for it
}

}  // namespace
}  // namespace stirsph
