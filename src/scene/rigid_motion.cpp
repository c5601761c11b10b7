#include "scene/rigid_motion.hpp"

#include <algorithm>
#include <cmath>

namespace stirsph {

RigidMotion::RigidMotion(const MotionScene& scene, const BilletStiffness& billet) : scene_(scene) {
  if (scene_.kind != MotionScene::Kind::Force) return;
  // Critically damped loop around the billet as a spring: V = I + Kp e, dI/dt = Ki e.
  const double stiffness = scene_.stiffness > 0 ? scene_.stiffness : billet.stiffness;
  const double frequency = scene_.bandwidth * billet.angular_frequency;
  integral_gain_ = frequency * frequency / stiffness;
  proportional_ = 2 * frequency / stiffness;
  filter_rate_ = 4 * frequency;
}

RigidPose RigidMotion::initial_pose() const {
  RigidPose pose;
  pose.centre = scene_.centre;
  pose.axis = scene_.axis;
  pose.angular_velocity = rate(0);
  for (int d = 0; d < 3; ++d)
    if (scene_.velocity[d]) pose.velocity[d] = (*scene_.velocity[d])({0.0});
  if (scene_.table) pose.translation = scene_.direction * scene_.table->value(0);
  return pose;
}

double RigidMotion::rate(double t) const {
  if (scene_.rotation_table) return scene_.rotation_table->value(t);
  return scene_.rotation ? (*scene_.rotation)({t}) : 0.0;
}

double RigidMotion::target_force(double t) const {
  const double preload = scene_.preload * std::min(1.0, t / scene_.approach_time);
  const double ramp = scene_.ramp_rate * std::max(0.0, t - scene_.dwell);
  return std::min(preload + ramp, scene_.target);
}

double RigidMotion::controlled_speed(double t, double dt, double force) {
  filtered_ += (force - filtered_) * (1 - std::exp(-filter_rate_ * dt));
  const double error = target_force(t) - filtered_;
  const double wanted = integral_ + integral_gain_ * error * dt + proportional_ * error;
  const double speed = std::clamp(wanted, -scene_.velocity_limit, scene_.velocity_limit);
  at_limit_ = speed != wanted;
  // Anti-windup: while the limit holds, the integral must not grow beyond what the limit allows.
  integral_ = std::clamp(at_limit_ ? integral_ : integral_ + integral_gain_ * error * dt, -scene_.velocity_limit,
                         scene_.velocity_limit);
  return speed;
}

void RigidMotion::advance(RigidPose& pose, double t, double dt, const Vec3& force) {
  const double middle = t + 0.5 * dt;
  pose.angular_velocity = rate(middle);
  pose.angle += pose.angular_velocity * dt;
  switch (scene_.kind) {
    case MotionScene::Kind::Fixed:
      pose.velocity = {};
      return;
    case MotionScene::Kind::Velocity:
      for (int d = 0; d < 3; ++d) pose.velocity[d] = scene_.velocity[d] ? (*scene_.velocity[d])({middle}) : 0.0;
      break;
    case MotionScene::Kind::Displacement: {
      // Follows the table exactly: the position at t + dt is the table's, whatever the steps before.
      const Vec3 target = scene_.direction * scene_.table->value(t + dt);
      pose.velocity = (target - pose.translation) / dt;
      break;
    }
    case MotionScene::Kind::Force:
      pose.velocity = scene_.direction * controlled_speed(middle, dt, -dot(force, scene_.direction));
      break;
  }
  pose.translation += pose.velocity * dt;
}

double RigidMotion::speed_bound(double radius) const {
  double bound = std::abs(rate(0)) * radius;
  if (scene_.kind == MotionScene::Kind::Force) bound += scene_.velocity_limit;
  return bound;
}

void RigidMotion::restore(const std::vector<double>& state) {
  integral_ = state.at(0);
  filtered_ = state.at(1);
  at_limit_ = state.at(2) != 0;
}

}  // namespace stirsph
