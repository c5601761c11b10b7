/// A rigid body: a shape carried by a motion (translation plus rotation about one axis).
#pragma once

#include <string>

#include "geometry/shape.hpp"

namespace stirsph {

/// Where a rigid body is and how it moves at one instant. The axis passes through `centre` and travels with the body.
struct RigidPose {
  Vec3 centre;                  ///< m, point on the rotation axis at the start
  Vec3 axis{0, 0, 1};           ///< unit vector; positive rotation by the right-hand rule
  Vec3 translation;             ///< m since the start
  double angle = 0;             ///< rad since the start
  Vec3 velocity;                ///< m/s
  double angular_velocity = 0;  ///< rad/s

  Vec3 axis_point() const { return centre + translation; }
  /// Where a point of the scene is in the body's frame, that is, where it was on the body at the start; and back.
  Vec3 to_body(const Vec3& x) const { return rotated(x - axis_point(), axis, -angle) + centre; }
  Vec3 to_scene(const Vec3& x) const { return rotated(x - centre, axis, angle) + axis_point(); }
  /// Velocity [m/s] of the body's material at a point.
  Vec3 velocity_at(const Vec3& x) const { return velocity + angular_velocity * cross(axis, x - axis_point()); }
};

struct RigidBody {
  std::string name;
  ShapePointer shape;
  RigidPose pose;

  /// Nearest surface point in the frame of the scene.
  SurfacePoint nearest(const Vec3& x) const {
    SurfacePoint found = shape->nearest(pose.to_body(x));
    found.normal = rotated(found.normal, pose.axis, pose.angle);
    return found;
  }
};

}  // namespace stirsph
