/// Coordinates about the axis of a round shape, shared by the solids of revolution.
#pragma once

#include <algorithm>
#include <cmath>
#include <string>

#include <fmt/format.h>

#include "base/error.hpp"
#include "base/tensor.hpp"

namespace stirsph {

inline std::string shown(const Vec3& v) { return fmt::format("({}, {}, {})", v.x, v.y, v.z); }

/// A unit vector across the axis; x for the axes y and z, so that shapes in the plane z = 0 keep their normals in it.
inline Vec3 across(const Vec3& axis) {
  const Vec3 candidate = std::abs(axis.x) < 0.9 ? Vec3{1, 0, 0} : Vec3{0, 1, 0};
  return normalised(candidate - dot(candidate, axis) * axis);
}

/// Coordinates of a point about an axis.
struct Cylindrical {
  double r, z;
  Vec3 radial;  ///< unit vector
};
inline Cylindrical about(const Vec3& base, const Vec3& axis, const Vec3& point) {
  const Vec3 offset = point - base;
  const double z = dot(offset, axis);
  const Vec3 radial = offset - z * axis;
  const double r = norm(radial);
  return {r, z, r > 0 ? radial / r : across(axis)};
}

/// How far a unit disc across the axis reaches along coordinate i.
inline double disc_reach(const Vec3& axis, int i) { return std::sqrt(std::max(0.0, 1 - axis[i] * axis[i])); }

inline Vec3 unit_axis(const Vec3& axis) {
  if (!(norm(axis) > 0 && std::isfinite(norm(axis))))
    throw InputError("the axis or normal of a shape must have a finite length > 0");
  return normalised(axis);
}

}  // namespace stirsph
