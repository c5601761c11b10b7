#include "scene/axial_symmetry.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace stirsph {
namespace {

const char* const advice = "or take space = \"cartesian3\"";

/// Where shapes are looked at: the extent of all bounded ones, so that endless ones are tested where it matters.
struct Extent {
  double radius = 0, low = 0, high = 0;

  void add(const Bounds& bounds) {
    for (const double value : {bounds.low.x, bounds.high.x, bounds.low.y, bounds.high.y})
      if (std::isfinite(value)) radius = std::max(radius, std::abs(value));
    if (std::isfinite(bounds.low.z)) low = std::min(low, bounds.low.z);
    if (std::isfinite(bounds.high.z)) high = std::max(high, bounds.high.z);
  }
};

/// Compares signed distances around the axis. Far outside a shape its distance may be one that only looks round near
/// the surface, such as that of a cylinder cut by a large box; what counts is the surface and what lies within.
void check_shape(const std::string& place, const ShapeFunction& shape, Extent extent, double spacing) {
  extent.add(shape.bounds());
  constexpr int steps = 48, angles = 12;
  const double golden = std::numbers::pi * (3 - std::sqrt(5.0));  // no symmetry of a polygon meets it
  const double allowed = 1e-3 * spacing;
  const double radius = extent.radius + spacing, low = extent.low - spacing, high = extent.high + spacing;
  for (int i = 1; i <= steps; ++i)
    for (int k = 0; k <= steps; ++k) {
      const double r = radius * i / steps, z = low + (high - low) * k / steps;
      const auto distance_at = [&](double angle) {
        return std::min(shape.distance({r * std::cos(angle), r * std::sin(angle), z}), 2 * spacing);
      };
      const double first = distance_at(0);
      for (int a = 1; a < angles; ++a)
        if (const double other = distance_at(a * golden); std::abs(other - first) > allowed) {
          const double degrees = std::fmod(a * golden * 180 / std::numbers::pi, 360);
          throw InputError(fmt::format(
              "{}.shape: {} is not round about the z axis, as space = \"axisymmetric\" needs it: at r = {:.4g} mm, z = "
              "{:.4g} mm the distance from its surface is {:.4g} mm in the direction of x and {:.4g} mm at {:.0f} "
              "degrees; allowed is a difference of {:.2g} mm. Centre it on the z axis and let its axis be that of z, "
              "{}",
              place, shape.describe(), 1e3 * r, 1e3 * z, 1e3 * first, 1e3 * other, degrees, 1e3 * allowed, advice));
        }
    }
}

void check_rotation(const std::string& place, const Vec3& centre, const Vec3& axis, double spacing) {
  const double aside = std::hypot(centre.x, centre.y);
  if (std::hypot(axis.x, axis.y) > 1e-9)
    throw InputError(
        fmt::format("{}.rotation.axis = [{:.6g}, {:.6g}, {:.6g}]: in the axisymmetric space everything turns "
                    "about the z axis. Allowed: [0, 0, 1] and [0, 0, -1]; {}",
                    place, axis.x, axis.y, axis.z, advice));
  if (aside > 1e-6 * spacing)
    throw InputError(
        fmt::format("{}.rotation.centre lies {:.4g} mm beside the z axis: in the axisymmetric space "
                    "everything turns about that axis. Allowed: x = y = 0; {}",
                    place, 1e3 * aside, advice));
}

void check_direction(const std::string& place, const Vec3& direction) {
  if (std::hypot(direction.x, direction.y) > 1e-9)
    throw InputError(
        fmt::format("{}.motion.direction = [{:.6g}, {:.6g}, {:.6g}]: in the axisymmetric space bodies move "
                    "along z only. Allowed: [0, 0, 1] and [0, 0, -1]; {}",
                    place, direction.x, direction.y, direction.z, advice));
}

/// `constant_only`: formulas may stand for a radial or swirling motion and are taken.
void check_across(const std::string& place, const std::array<OptionalExpression, 3>& vector, bool constant_only) {
  for (int d = 0; d < 2; ++d) {
    if (!vector[d] || (constant_only && !vector[d]->is_constant())) continue;
    if (vector[d]->is_constant() && (*vector[d])({0, 0, 0, 0}) == 0) continue;
    throw InputError(
        fmt::format("{}.{} = \"{}\": in the axisymmetric space nothing is pushed or moved across the z axis. Allowed: "
                    "0{}, and any value of z; {}",
                    place, "xy"[d], vector[d] -> text(),
                    constant_only ? ", a formula of x, y, z, which stand for r, theta, z at y = 0" : "", advice));
  }
}

}  // namespace

void check_axial_symmetry(const Scene& scene) {
  if (!layout_of(scene.space).axisymmetric()) return;
  const double spacing = scene.numerics.spacing;
  Extent extent;
  for (const BodyScene& body : scene.bodies) extent.add(body.shape->bounds());
  for (const RigidScene& rigid : scene.rigids) extent.add(rigid.shape->bounds());
  for (const BodyScene& body : scene.bodies) {
    const std::string place = scene.path + " body \"" + body.name + "\"";
    check_shape(place, *body.shape, extent, spacing);
    check_across(place + ".velocity", body.velocity, true);
    if (body.rotation) check_rotation(place, body.rotation->centre, body.rotation->axis, spacing);
  }
  for (const RigidScene& rigid : scene.rigids) {
    const std::string place = scene.path + " rigid \"" + rigid.name + "\"";
    check_shape(place, *rigid.shape, extent, spacing);
    check_across(place + ".motion", rigid.motion.velocity, false);
    if (rigid.motion.rotation) check_rotation(place, rigid.motion.centre, rigid.motion.axis, spacing);
    if (rigid.motion.kind == MotionScene::Kind::Displacement || rigid.motion.kind == MotionScene::Kind::Force)
      check_direction(place, rigid.motion.direction);
  }
  for (const GripScene& grip : scene.grips) {
    const std::string place = scene.path + " grip \"" + grip.name + "\"";
    check_across(place + ".velocity", grip.velocity, true);
    if (grip.rotation) check_rotation(place, grip.rotation->centre, grip.rotation->axis, spacing);
  }
  check_across(scene.path + " body_force", scene.body_force, false);
}

}  // namespace stirsph
