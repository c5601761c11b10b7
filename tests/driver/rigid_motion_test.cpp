/// Tool control: displacement table, force programme and its controller, rotation.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <numbers>
#include <string>
#include <utility>

#include "scene/rigid_motion.hpp"

namespace stirsph {
namespace {

constexpr double pi = std::numbers::pi;

MotionScene programme() {
  MotionScene scene;
  scene.kind = MotionScene::Kind::Force;
  scene.direction = {0, 0, -1};
  scene.force = {.preload = 5e3, .dwell = 5, .ramp_rate = 500, .target = 12e3};
  return scene;
}

/// A rod on a rigid ground, pressed at its end, as masses and springs with some internal damping. `strength` weakens or
/// stiffens all of it; what is left of the shape is that of the springs, so a sudden loss relaxes the force.
class Rod {
 public:
  explicit Rod(double angular_frequency = 500, double gap = 0)
      : gap_(gap), mass_(stiffness * std::pow(0.5 * pi / angular_frequency, 2) / pieces) {
    billet = {stiffness, angular_frequency, stiffness * 0.5 * pi / angular_frequency};
  }

  /// Moves the rod over dt with the tool at `tool` (m from its start) and returns the contact force [N].
  double press(double tool, double dt) {
    const double k = stiffness * pieces * strength, damping = 0.05 * std::sqrt(k * mass_);
    double force = 0;
    for (int part = 0; part < substeps; ++part) {
      force = std::max(0.0, 2 * stiffness * pieces * (tool - gap_ - place_[0]));
      std::array<double, pieces + 1> tension{};  // above piece i
      tension[0] = -force;
      for (int i = 0; i < pieces; ++i) {
        const double below = i + 1 < pieces ? place_[i + 1] : 0, speed = i + 1 < pieces ? speed_[i + 1] : 0;
        tension[i + 1] = k * (below - place_[i]) + damping * (speed - speed_[i]);
      }
      for (int i = 0; i < pieces; ++i) speed_[i] += dt / substeps * (tension[i + 1] - tension[i]) / mass_;
      for (int i = 0; i < pieces; ++i) place_[i] += dt / substeps * speed_[i];
    }
    return force;
  }

  static constexpr int pieces = 20, substeps = 4;
  static constexpr double stiffness = 1e7;  // N/m
  BilletStiffness billet;
  double strength = 1;

 private:
  double gap_, mass_;
  std::array<double, pieces> place_{}, speed_{};
};

/// A tool under force control on a rod.
struct Press {
  Press(const MotionScene& scene, Rod billet) : rod(std::move(billet)), motion(scene, rod.billet) {
    pose = motion.initial_pose();
  }
  void step() {
    motion.advance(pose, time, dt, {0, 0, force});
    time += dt;
    force = rod.press(-pose.translation.z, dt);
    if (control().phase() != ForceControl::Phase::Search)
      overshoot = std::max(overshoot, force - control().target_force());
  }
  void until(double end) {
    while (time < end - 0.5 * dt) step();
  }
  const ForceControl& control() const { return *motion.force_control(); }

  static constexpr double dt = 1e-4;
  Rod rod;
  RigidMotion motion;
  RigidPose pose;
  double time = 0, force = 0, overshoot = 0;
};

TEST(ForceProgramme, IsThePapers) {
  // physics.md section 1: 5 kN, 5 s dwell, then 0.5 kN/s up to 12 kN, held; all from the moment of contact.
  ForceControl control(programme().force, {1e7, 100, 1e4});
  EXPECT_EQ(control.target_force(), 0);
  EXPECT_EQ(control.phase(), ForceControl::Phase::Search);
  const double dt = 1e-3;
  double time = 0;
  const auto until = [&](double end) {
    for (; time < end - 0.5 * dt; time += dt) control.speed(dt, std::max(150.0, control.target_force()), 0);
    return control.target_force();
  };
  EXPECT_NEAR(until(0.1), 2500 + 150, 5);  // raised from the force that was felt
  EXPECT_NEAR(until(0.5), 5000, 1e-6);
  EXPECT_NEAR(until(4.99), 5000, 1e-6);
  EXPECT_EQ(control.phase(), ForceControl::Phase::Preload);
  EXPECT_NEAR(until(7), 6000, 1e-6);
  EXPECT_EQ(control.phase(), ForceControl::Phase::Ramp);
  EXPECT_NEAR(until(19.01), 12000, 1e-6);
  EXPECT_EQ(control.phase(), ForceControl::Phase::Hold);
  EXPECT_NEAR(until(40), 12000, 1e-6);
  EXPECT_NEAR(control.contact_time(), 40, 1e-9);
  EXPECT_NEAR(control.time_since_end(), 21, 0.01);
}

TEST(ForceControl, BringsTheForceOfARodToTheProgramme) {
  MotionScene scene = programme();
  scene.force.dwell = 1;
  scene.force.target = 6e3;
  Press press(scene, Rod());
  press.until(0.7);  // 0.5 mm at no more than 1 mm/s, and some settling
  EXPECT_NEAR(press.force, 5e3, 0.01 * 5e3);
  press.until(1);
  EXPECT_NEAR(press.force, 5e3, 0.005 * 5e3);
  press.until(4);
  EXPECT_NEAR(press.force, 6e3, 10);
  EXPECT_LT(press.overshoot, 0.03 * 5e3);
  std::printf("overshoot on a rod: %.2f %% of the preload\n", press.overshoot / 50);
}

/// The tool starts above the billet: it approaches, and dwell and ramp are counted from the contact.
TEST(ContactSearch, StartsTheClockAtContact) {
  MotionScene scene = programme();
  scene.force.dwell = 1;
  scene.force.target = 6e3;
  const double gap = 0.5e-3, expected = gap / scene.force.velocity_limit;  // light billet: the limit is the speed
  Press press(scene, Rod(500, gap));
  press.until(0.98 * expected);
  EXPECT_EQ(press.control().phase(), ForceControl::Phase::Search);
  EXPECT_EQ(press.control().contact_time(), 0);
  EXPECT_EQ(press.control().target_force(), 0);
  EXPECT_FALSE(press.control().at_velocity_limit());
  while (press.control().phase() == ForceControl::Phase::Search) press.step();
  const double contact = press.time;
  EXPECT_NEAR(contact, expected, 0.05);
  press.until(contact + 0.99);
  EXPECT_NEAR(press.force, 5e3, 0.01 * 5e3);
  EXPECT_EQ(press.control().phase(), ForceControl::Phase::Preload);
  press.until(contact + 2);
  EXPECT_NEAR(press.control().target_force(), 5500, 1);
  press.until(contact + 4);
  EXPECT_NEAR(press.force, 6e3, 10);
  EXPECT_NEAR(press.control().contact_time(), 4, 1e-3);
  EXPECT_LT(press.overshoot, 0.03 * 5e3);
}

/// A billet heavy from mass scaling: the approach speed is lowered until the impact is a fifth of the preload.
TEST(ContactSearch, LimitsTheImpactOnAHeavyBillet) {
  MotionScene scene = programme();
  scene.force.dwell = 100;
  scene.force.velocity_limit = 10e-3;
  const Rod heavy(20, 0.2e-3);
  Press press(scene, heavy);
  EXPECT_NEAR(press.control().approach_speed(), 0.2 * 5e3 / heavy.billet.impedance, 1e-12);
  EXPECT_LT(press.control().approach_speed(), 0.2 * scene.force.velocity_limit);
  EXPECT_NEAR(press.control().impact_force(), 1e3, 1e-9);
  double impact = 0;
  while (press.control().contact_time() < 0.05) {  // before the preload itself is raised
    press.step();
    impact = std::max(impact, press.force);
  }
  EXPECT_LT(impact, 1.3 * 1e3);  // a chain of masses rings a little
  EXPECT_GT(impact, 0.5 * 1e3);
  press.until(6);
  EXPECT_NEAR(press.force, 5e3, 0.02 * 5e3);
  std::printf("impact %.0f N, estimate %.0f N\n", impact, press.control().impact_force());
  // Given speeds are taken as they are, also beyond the velocity limit.
  scene.force.approach_speed = 0.02;
  EXPECT_EQ(RigidMotion(scene, heavy.billet).force_control()->approach_speed(), 0.02);
}

/// Contact is lost when the billet gives way altogether: the clock stands still and goes on with the next contact.
TEST(ContactSearch, PausesTheProgrammeWhileContactIsLost) {
  MotionScene scene = programme();
  scene.force.dwell = 1;
  scene.force.ramp_rate = 1000;
  scene.force.target = 8e3;
  Press press(scene, Rod());
  press.until(2);
  const double before = press.control().contact_time();
  EXPECT_NEAR(press.control().target_force(), 5e3 + 1000 * (before - 1), 1e-6);
  for (int n = 0; n < 5000; ++n) {  // 0.5 s without any force
    press.motion.advance(press.pose, press.time, Press::dt, {});
    press.time += Press::dt;
  }
  EXPECT_EQ(press.control().phase(), ForceControl::Phase::Search);
  EXPECT_LT(press.control().contact_time() - before, 0.05);
  EXPECT_NEAR(-press.pose.velocity.z, press.control().approach_speed(), 1e-15);
  const double paused = press.control().contact_time();
  press.force = 400;  // felt again: no step of the force
  press.motion.advance(press.pose, press.time, Press::dt, {0, 0, press.force});
  EXPECT_GT(press.control().target_force(), 400);
  EXPECT_LT(press.control().target_force(), 450);
  EXPECT_NEAR(press.control().contact_time(), paused + Press::dt, 1e-12);
}

/// Two millimetres of a soft layer at the velocity limit, then hard ground: had the integral grown meanwhile, the tool
/// would crash into it.
TEST(ForceControl, DoesNotWindUpAtTheVelocityLimit) {
  MotionScene scene = programme();
  scene.force.dwell = 100;
  RigidMotion motion(scene, Rod().billet);
  RigidPose pose = motion.initial_pose();
  const double dt = 1e-4;
  double largest = 0, limited = 0;
  const auto force = [&] { return -pose.translation.z * 2e5 + std::max(0.0, -pose.translation.z - 2e-3) * 1e7; };
  for (double t = 0; t < 6; t += dt) {
    motion.advance(pose, t, dt, {0, 0, force()});
    ASSERT_LE(-pose.velocity.z, scene.force.velocity_limit * (1 + 1e-12));
    limited += motion.force_control()->at_velocity_limit() * dt;
    largest = std::max(largest, force());
  }
  EXPECT_GT(limited, 1.4);
  EXPECT_NEAR(motion.force_control()->time_at_velocity_limit(), limited, 1e-9);
  EXPECT_NEAR(force(), 5e3, 10);
  EXPECT_LT(largest, 1.02 * 5e3);
  std::printf("overshoot after %.2f s at the limit: %.2f %%\n", limited, (largest - 5e3) / 50);
}

/// At once the billet has a fifth of its strength: the force falls, is brought back, and does not shoot over.
TEST(ForceControl, RecoversFromASuddenLossOfStrength) {
  MotionScene scene = programme();
  scene.force.dwell = 100;
  Press press(scene, Rod());
  press.until(1);
  press.overshoot = 0;
  press.rod.strength = 0.2;
  press.until(1.1);
  EXPECT_LT(press.force, 0.5 * 5e3);
  EXPECT_TRUE(press.control().at_velocity_limit());
  press.until(5);
  EXPECT_NEAR(press.force, 5e3, 0.005 * 5e3);
  EXPECT_LT(press.overshoot, 0.05 * 5e3);
  std::printf("overshoot after a loss of 80 %% of the strength: %.2f %%\n", press.overshoot / 50);
}

/// Softening and stiffening with time, as metal that heats up and a container that fills.
TEST(ForceControl, FollowsABilletThatSoftensAndStiffens) {
  MotionScene scene = programme();
  scene.force.dwell = 100;
  scene.force.velocity_limit = 10e-3;  // softening tenfold in 2 s needs up to 6 mm/s
  for (const double last : {0.1, 5.0}) {
    Press press(scene, Rod());
    press.until(1);
    press.overshoot = 0;
    double largest = 0;
    for (; press.time < 3; press.step()) {
      press.rod.strength = std::pow(last, 0.5 * (press.time - 1));
      largest = std::max(largest, std::abs(press.force - 5e3));
    }
    press.until(4);
    EXPECT_NEAR(press.force, 5e3, 0.01 * 5e3) << last;
    EXPECT_LT(largest, 0.15 * 5e3) << last;
    std::printf("strength to %g in 2 s: largest error %.1f %%, overshoot %.1f %%\n", last, largest / 50,
                press.overshoot / 50);
  }
}

TEST(ForceControl, LimitsTheWithdrawalByItself) {
  MotionScene scene = programme();
  scene.force.withdrawal_limit = 0.2e-3;
  ForceControl control(scene.force, {1e7, 500, 0});
  double slowest = 0;
  for (int n = 0; n < 1000; ++n) slowest = std::min(slowest, control.speed(1e-4, 50e3, 0));
  EXPECT_EQ(slowest, -0.2e-3);
  EXPECT_TRUE(control.at_velocity_limit());
}

TEST(ForceControl, StopsAtTheStrokeLimit) {
  MotionScene scene = programme();
  scene.force.dwell = 1;
  scene.force.stroke_limit = 0.51e-3;  // 5.1 kN on the rod
  Press press(scene, Rod());
  press.until(6);
  EXPECT_EQ(press.control().phase(), ForceControl::Phase::StrokeEnd);
  EXPECT_EQ(press.motion.remark(), "at its stroke limit");
  EXPECT_NEAR(-press.pose.translation.z, 0.51e-3, 1e-15);
  EXPECT_EQ(norm(press.pose.velocity), 0);
  EXPECT_GT(press.control().time_since_end(), 3);
  // The search stops there as well.
  Press missing(scene, Rod(500, 1e-3));
  missing.until(2);
  EXPECT_NEAR(-missing.pose.translation.z, 0.51e-3, 1e-15);
  EXPECT_EQ(missing.control().phase(), ForceControl::Phase::StrokeEnd);
}

/// The density scale changes during a run: new gains, and no jump of speed or programme.
TEST(ForceControl, RenewsItsGainsWithoutLosingItsState) {
  MotionScene scene = programme();
  scene.force.dwell = 100;
  Press press(scene, Rod());
  press.until(2);
  const auto state = press.motion.state();
  const Rod lighter(2000);
  press.motion.renew_gains(lighter.billet);
  EXPECT_EQ(press.motion.state(), state);
  RigidMotion fresh(scene, lighter.billet);
  fresh.restore(state);
  RigidPose a = press.pose, b = press.pose;
  press.motion.advance(a, 2, 1e-4, {0, 0, 4e3});
  fresh.advance(b, 2, 1e-4, {0, 0, 4e3});
  EXPECT_EQ(a.velocity.z, b.velocity.z);
  EXPECT_LT(a.velocity.z, 0);
}

/// In every phase, the controller and the retreat go on from their saved state bit by bit.
TEST(Restart, ContinuesFromTheSavedState) {
  MotionScene scene = programme();
  scene.force.dwell = 0.3;
  scene.force.target = 5.5e3;
  scene.retreat = RetreatScene{.dwell = 0.3, .speed = 1e-3, .distance = 1e-3};
  for (const double at : {0.1, 0.6, 1.0, 2.0, 2.3}) {
    Press straight(scene, Rod(500, 0.2e-3));
    straight.until(at);
    Press second = straight;
    second.motion = RigidMotion(scene, straight.rod.billet);
    second.motion.restore(straight.motion.state());
    straight.until(at + 0.5);
    second.until(at + 0.5);
    EXPECT_EQ(straight.pose.translation.z, second.pose.translation.z) << at;
    EXPECT_EQ(straight.motion.state(), second.motion.state()) << at;
  }
}

TEST(Retreat, EndsTheForceProgramme) {
  MotionScene scene = programme();
  scene.force.dwell = 0.5;
  scene.force.target = 5.5e3;
  scene.retreat = RetreatScene{.dwell = 1, .speed = 2e-3, .distance = 3e-3};
  Press press(scene, Rod());
  while (!press.motion.retreating()) {
    ASSERT_LT(press.time, 4);
    press.step();
  }
  EXPECT_NEAR(press.time, 0.5 + 1 + 1, 0.05);  // dwell, ramp of 1 s, dwell at the target; contact within 0.02 s
  const double lowest = press.pose.translation.z;
  press.until(press.time + 1);
  EXPECT_NEAR(press.pose.velocity.z, 2e-3, 1e-12);
  EXPECT_EQ(press.force, 0);
  press.until(press.time + 1);
  EXPECT_NEAR(press.pose.translation.z - lowest, 3e-3, 1e-6);
  EXPECT_EQ(norm(press.pose.velocity), 0);
  EXPECT_EQ(press.motion.remark(), "retreating");
}

TEST(Retreat, LiftsOffAtATimeWhateverMovedTheBodyBefore) {
  for (const auto kind : {MotionScene::Kind::Fixed, MotionScene::Kind::Velocity, MotionScene::Kind::Displacement}) {
    MotionScene scene;
    scene.kind = kind;
    scene.velocity[2] = input::Expression(-1e-3);
    scene.table = TabulatedCurve({0, 5}, {0, 5e-3});
    scene.rotation = input::Expression(100.0);
    scene.retreat = RetreatScene{.at = 2.0, .speed = 4e-3, .distance = 6e-3, .stop_rotation = true};
    RigidMotion motion(scene, {});
    RigidPose pose = motion.initial_pose();
    auto until = [&, n = 0](double end) mutable {
      for (; n < std::lround(end / 0.03); ++n) motion.advance(pose, n * 0.03, 0.03, {});
    };
    until(1.98);
    const double lowest = pose.translation.z;
    EXPECT_NEAR(lowest, kind == MotionScene::Kind::Fixed ? 0 : -1.98e-3, 1e-9);
    EXPECT_EQ(pose.angular_velocity, 100);
    EXPECT_FALSE(motion.retreating());
    until(3);
    EXPECT_NEAR(pose.velocity.z, 4e-3, 1e-12);
    EXPECT_EQ(pose.angular_velocity, 0);
    until(6);
    const double before = kind == MotionScene::Kind::Fixed ? 0 : -2.01e-3;  // the step that begins before 2 s
    EXPECT_NEAR(pose.translation.z, before + 6e-3, 1e-9);
    EXPECT_EQ(norm(pose.velocity), 0);
  }
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

/// A table that ends before the run, or begins after its start, holds its end values: a dwell needs no further rows.
TEST(DisplacementTable, HoldsItsEndsAndThenRetreats) {
  MotionScene scene;
  scene.kind = MotionScene::Kind::Displacement;
  scene.direction = {0, 0, -1};
  scene.table = TabulatedCurve({1, 2}, {1e-3, 4e-3});
  scene.retreat = RetreatScene{.dwell = 3, .speed = 1e-3, .distance = 2e-3};
  RigidMotion motion(scene, {});
  RigidPose pose = motion.initial_pose();
  EXPECT_EQ(pose.translation.z, -1e-3);
  for (int n = 0; n < 1000; ++n) {
    const double t = 0.01 * n, end = t + 0.01;
    motion.advance(pose, t, 0.01, {});
    if (end < 1) {
      EXPECT_NEAR(norm(pose.velocity), 0, 1e-15);
    }
    if (end < 5) {
      EXPECT_NEAR(pose.translation.z, -scene.table->value(end), 1e-15);
    }
    if (end > 5.5 && end < 6.5) {
      EXPECT_NEAR(pose.velocity.z, 1e-3, 1e-12);
    }
  }
  EXPECT_NEAR(pose.translation.z, -2e-3, 1e-12);
  EXPECT_NE(motion.describe().find("from 1 s to 2 s, held before and after; retreat of 2 mm"), std::string::npos)
      << motion.describe();
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
