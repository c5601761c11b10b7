/// A rigid body: a shape carried by a motion (translation plus rotation about one axis).
#pragma once

#include <cmath>
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
  SurfacePoint nearest(const Vec3& x) const;
};

/// A rigid body at one instant, for questions about many points: its rotation is worked out once.
class PlacedBody {
 public:
  explicit PlacedBody(const RigidBody& body)
      : shape_(*body.shape),
        centre_(body.pose.centre),
        axis_point_(body.pose.axis_point()),
        axis_(body.pose.axis),
        cosine_(std::cos(body.pose.angle)),
        sine_(std::sin(body.pose.angle)) {}

  SurfacePoint nearest(const Vec3& x) const {
    SurfacePoint found = shape_.nearest(rotated(x - axis_point_, axis_, cosine_, -sine_) + centre_);
    found.normal = rotated(found.normal, axis_, cosine_, sine_);
    return found;
  }

 private:
  const ShapeFunction& shape_;
  Vec3 centre_, axis_point_, axis_;
  double cosine_, sine_;
};

inline SurfacePoint RigidBody::nearest(const Vec3& x) const { return PlacedBody(*this).nearest(x); }

}  // namespace stirsph
