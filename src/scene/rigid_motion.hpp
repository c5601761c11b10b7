/// Moves one rigid body: prescribed velocity, displacement table, or a force programme under PI control.
#pragma once

#include <vector>

#include "geometry/rigid_body.hpp"
#include "scene/scene.hpp"

namespace stirsph {

/// What the force controller must know of the billet it presses.
struct BilletStiffness {
  double stiffness = 0;          ///< N/m, E A/L with elastic scaling
  double angular_frequency = 0;  ///< rad/s of the first axial mode, with density and elastic scaling
};

class RigidMotion {
 public:
  RigidMotion(const MotionScene& scene, const BilletStiffness& billet);

  /// Pose at the start.
  RigidPose initial_pose() const;
  /// Advances the pose from t to t + dt. `force` [N]: of the particles on the body in the last step (for force
  /// control).
  void advance(RigidPose& pose, double t, double dt, const Vec3& force);

  /// The force [N] the programme asks for at time t: preload over the approach time, dwell, ramp, hold.
  double target_force(double t) const;
  bool force_controlled() const { return scene_.kind == MotionScene::Kind::Force; }
  bool at_velocity_limit() const { return at_limit_; }
  /// An upper bound of the body's own speed during the run, for the step size [m/s].
  double speed_bound(double radius) const;

  /// Controller state for checkpoints: integral, filtered force, velocity-limit flag.
  std::vector<double> state() const { return {integral_, filtered_, at_limit_ ? 1.0 : 0.0}; }
  void restore(const std::vector<double>& state);

 private:
  double controlled_speed(double t, double dt, double force);
  double rate(double t) const;

  MotionScene scene_;
  double proportional_ = 0, integral_gain_ = 0, filter_rate_ = 0;
  double integral_ = 0;  ///< m/s
  double filtered_ = 0;  ///< N
  bool at_limit_ = false;
};

}  // namespace stirsph
