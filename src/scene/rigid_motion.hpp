/// Moves one rigid body: prescribed velocity, displacement table, or a force programme; at the end a retreat.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "geometry/rigid_body.hpp"
#include "scene/force_control.hpp"
#include "scene/scene.hpp"

namespace stirsph {

class RigidMotion {
 public:
  RigidMotion(const MotionScene& scene, const BilletStiffness& billet);

  /// Pose at the start.
  RigidPose initial_pose() const;
  /// Advances the pose from t to t + dt. `force` [N]: of the particles on the body in the last step (for force
  /// control). Throws InputError when a formula has no value at this time.
  void advance(RigidPose& pose, double t, double dt, const Vec3& force);

  /// Null unless the body follows a force programme.
  const ForceControl* force_control() const { return control_ ? &*control_ : nullptr; }
  /// To be called when the billet's scaling has changed; nothing happens without force control.
  void renew_gains(const BilletStiffness& billet);
  bool retreating() const { return retreated_ > 0; }

  /// The plan in words, with the speeds chosen for it; empty for a body at rest or with a given velocity.
  std::string describe() const;
  /// What is out of the ordinary now, for a progress line: "at its velocity limit"; empty otherwise.
  std::string remark() const;

  /// For checkpoints: way of the retreat, and the force controller's.
  std::vector<double> state() const;
  void restore(const std::vector<double>& state);

 private:
  bool retreat_has_begun(double t) const;
  Vec3 retreat_velocity(double dt);
  double rate(double t) const;

  MotionScene scene_;
  std::optional<ForceControl> control_;
  double retreated_ = 0;  ///< m
};

}  // namespace stirsph
