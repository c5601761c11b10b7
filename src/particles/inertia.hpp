/// Scaled inertia: what a particle's mass counts in the equation of motion. With a tool that turns, most of the speed
/// is swirl around the z axis, and it is there that scaled mass does harm: it has a centrifugal force that the metal
/// does not have, and it takes long to be brought along. So the swirl may have a factor of its own, and its centrifugal
/// and Coriolis forces may be left out (exact as the true ones are negligible: some kPa).
#pragma once

#include <algorithm>
#include <cmath>

#include "base/tensor.hpp"

namespace stirsph {

struct Inertia {
  double scale = 1;           ///< s: inertial over physical mass
  double swirl_ratio = 1;     ///< the same of motion around the z axis, over s
  bool swirl = true;          ///< false: without the centrifugal and Coriolis forces of the swirl
  bool axisymmetric = false;  ///< velocities are v_r v_theta v_z at the place (r, 0, z)
  double core = 0;            ///< m: nearer to the axis a particle's motion is no longer told from a swirl
  double axis_reach = 0;      ///< m: nearer to the axis a ring's motion across it is made heavier, by (axis_reach/r)^2

  bool directional() const { return swirl_ratio != 1; }
  double swirl_scale() const { return scale * swirl_ratio; }
  /// Angular velocity [1/s] about the z axis of a particle at x with the velocity v.
  double spin(const Vec3& x, const Vec3& v) const {
    if (axisymmetric) return v.y / std::copysign(std::max(std::abs(x.x), core), x.x);
    return (x.x * v.y - x.y * v.x) / std::max(x.x * x.x + x.y * x.y, core * core);
  }
  /// Factor on the inertia of a ring's radial motion and swirl. Hoop stress makes the ring a spring of the frequency
  /// c/r, and its neighbours' shear turns it by a torque over its radius: for the innermost rings both would more than
  /// halve the stable step of all.
  double axis_factor(double r) const {
    const double ratio = axis_reach / std::max(std::abs(r), core);
    return std::max(1.0, ratio * ratio);
  }
  /// Per unit of physical mass.
  Vec3 momentum(const Vec3& x, const Vec3& v) const {
    if (axisymmetric) return scale * Vec3{axis_factor(x.x) * v.x, axis_factor(x.x) * swirl_ratio * v.y, v.z};
    return directional() ? scale * (v + (swirl_ratio - 1) * swirl_part(x, v)) : scale * v;
  }
  /// Acceleration by a force per unit of physical mass.
  Vec3 acceleration(const Vec3& x, const Vec3& force) const {
    if (axisymmetric)
      return Vec3{force.x / axis_factor(x.x), force.y / (axis_factor(x.x) * swirl_ratio), force.z} / scale;
    return directional() ? (force + (1 / swirl_ratio - 1) * swirl_part(x, force)) / scale : force / scale;
  }
  /// Twice the kinetic energy per unit of physical mass [m2/s2].
  double square(const Vec3& x, const Vec3& v) const { return dot(momentum(x, v), v); }
  /// The part of a velocity or force that is swirl.
  Vec3 swirl_part(const Vec3& x, const Vec3& v) const {
    if (axisymmetric) return {0, v.y, 0};
    const double omega = spin(x, v);
    return {-omega * x.y, omega * x.x, 0};
  }
};

}  // namespace stirsph
