#include "geometry/primitives.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "base/error.hpp"
#include "geometry/about_axis.hpp"
#include "geometry/revolved_profile.hpp"

namespace stirsph {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

void expect(bool condition, const char* message) {
  if (!condition) throw InputError(message);
}

}  // namespace

HalfSpace::HalfSpace(const Vec3& point, const Vec3& normal) : point_(point), normal_(unit_axis(normal)) {}

SurfacePoint HalfSpace::nearest(const Vec3& point) const { return {dot(point - point_, normal_), normal_}; }

Bounds HalfSpace::bounds() const {
  Bounds result{{-infinity, -infinity, -infinity}, {infinity, infinity, infinity}};
  for (int i = 0; i < 3; ++i) {
    if (normal_[i] == 1) result.high[i] = point_[i];
    if (normal_[i] == -1) result.low[i] = point_[i];
  }
  return result;
}

std::string HalfSpace::describe() const {
  return fmt::format("half space below {} m, normal {}", shown(point_), shown(normal_));
}

Box::Box(const Vec3& low, const Vec3& high) : bounds_{low, high} {
  for (int i = 0; i < 3; ++i) expect(low[i] < high[i], "the low corner of a box must lie below the high corner");
}

SurfacePoint Box::nearest(const Vec3& point) const {
  Vec3 beyond, side;  // how far outside the slab of each direction (negative inside), and on which side
  int face = 0;
  for (int i = 0; i < 3; ++i) {
    const double below = bounds_.low[i] - point[i], above = point[i] - bounds_.high[i];
    beyond[i] = std::max(below, above);
    side[i] = above >= below ? 1 : -1;
    if (beyond[i] > beyond[face]) face = i;
  }
  Vec3 away;
  for (int i = 0; i < 3; ++i) away[i] = std::max(beyond[i], 0.0) * side[i];
  const double distance = norm(away);
  if (distance > 0) return {distance, away / distance};
  Vec3 normal;
  normal[face] = side[face];
  return {beyond[face], normal};
}

std::string Box::describe() const {
  return fmt::format("box from {} m to {} m", shown(bounds_.low), shown(bounds_.high));
}

Sphere::Sphere(const Vec3& centre, double radius) : centre_(centre), radius_(radius) {
  expect(radius > 0, "the radius of a sphere must be > 0");
}

SurfacePoint Sphere::nearest(const Vec3& point) const {
  const Vec3 offset = point - centre_;
  const double r = norm(offset);
  return {r - radius_, r > 0 ? offset / r : Vec3{1, 0, 0}};
}

Bounds Sphere::bounds() const {
  const Vec3 reach{radius_, radius_, radius_};
  return {centre_ - reach, centre_ + reach};
}

std::string Sphere::describe() const {
  return fmt::format("sphere, centre {} m, radius {} m", shown(centre_), radius_);
}

Torus::Torus(const Vec3& centre, const Vec3& axis, double ring_radius, double section_radius)
    : centre_(centre), axis_(unit_axis(axis)), ring_radius_(ring_radius), section_radius_(section_radius) {
  expect(section_radius > 0 && ring_radius > section_radius,
         "a torus needs a section radius > 0 and a larger ring radius");
}

SurfacePoint Torus::nearest(const Vec3& point) const {
  const auto [r, z, radial] = about(centre_, axis_, point);
  const double across_ring = r - ring_radius_, d = std::hypot(across_ring, z);
  if (d == 0) return {-section_radius_, radial};
  return {d - section_radius_, (across_ring / d) * radial + (z / d) * axis_};
}

Bounds Torus::bounds() const {
  Vec3 reach;
  for (int i = 0; i < 3; ++i) reach[i] = ring_radius_ * disc_reach(axis_, i) + section_radius_;
  return {centre_ - reach, centre_ + reach};
}

std::string Torus::describe() const {
  return fmt::format("torus, centre {} m, axis {}, ring radius {} m, section radius {} m", shown(centre_), shown(axis_),
                     ring_radius_, section_radius_);
}

EndlessTube::EndlessTube(const Vec3& base, const Vec3& axis, double inner_radius, double outer_radius)
    : base_(base), axis_(unit_axis(axis)), inner_radius_(inner_radius), outer_radius_(outer_radius) {
  expect(inner_radius >= 0 && outer_radius > inner_radius, "radii must satisfy 0 <= inner < outer");
}

SurfacePoint EndlessTube::nearest(const Vec3& point) const {
  const auto [r, z, radial] = about(base_, axis_, point);
  const double outside = r - outer_radius_, in_hole = inner_radius_ - r;
  if (inner_radius_ > 0 && in_hole > outside) return {in_hole, -radial};
  return {outside, radial};
}

Bounds EndlessTube::bounds() const {
  Bounds result;
  for (int i = 0; i < 3; ++i) {
    const double reach = axis_[i] == 0 ? outer_radius_ : infinity;
    result.low[i] = base_[i] - reach;
    result.high[i] = base_[i] + reach;
  }
  return result;
}

std::string EndlessTube::describe() const {
  const std::string hole = inner_radius_ > 0 ? fmt::format("inner radius {} m, ", inner_radius_) : "";
  return fmt::format("endless {}, through {} m, axis {}, {}radius {} m", inner_radius_ > 0 ? "annulus" : "cylinder",
                     shown(base_), shown(axis_), hole, outer_radius_);
}

ShapePointer make_cylinder(const Vec3& base, const Vec3& axis, double radius, std::optional<double> height) {
  expect(radius > 0, "the radius of a cylinder must be > 0");
  if (!height || *height == infinity) return std::make_shared<EndlessTube>(base, axis, 0.0, radius);
  expect(*height > 0, "the height of a cylinder must be > 0");
  return std::make_shared<RevolvedProfile>(
      base, axis, std::vector<RevolvedProfile::Vertex>{{0, 0}, {radius, 0}, {radius, *height}, {0, *height}},
      fmt::format("cylinder, base {} m, axis {}, radius {} m, height {} m", shown(base), shown(axis), radius, *height));
}

ShapePointer make_annulus(const Vec3& base, const Vec3& axis, double inner_radius, double outer_radius,
                          std::optional<double> height) {
  expect(inner_radius > 0 && outer_radius > inner_radius, "the radii of an annulus must satisfy 0 < inner < outer");
  if (!height || *height == infinity) return std::make_shared<EndlessTube>(base, axis, inner_radius, outer_radius);
  expect(*height > 0, "the height of an annulus must be > 0");
  return std::make_shared<RevolvedProfile>(
      base, axis,
      std::vector<RevolvedProfile::Vertex>{
          {inner_radius, 0}, {outer_radius, 0}, {outer_radius, *height}, {inner_radius, *height}},
      fmt::format("annulus, base {} m, axis {}, inner radius {} m, outer radius {} m, height {} m", shown(base),
                  shown(axis), inner_radius, outer_radius, *height));
}

ShapePointer make_frustum(const Vec3& base, const Vec3& axis, double base_radius, double top_radius, double height) {
  expect(height > 0 && base_radius >= 0 && top_radius >= 0 && base_radius + top_radius > 0,
         "a frustum needs a height > 0, radii >= 0 and one radius > 0");
  std::vector<RevolvedProfile::Vertex> vertices{{0, 0}};
  if (base_radius > 0) vertices.push_back({base_radius, 0});
  if (top_radius > 0) vertices.push_back({top_radius, height});
  vertices.push_back({0, height});
  return std::make_shared<RevolvedProfile>(base, axis, std::move(vertices),
                                           fmt::format("frustum, base {} m, axis {}, radii {} m and {} m, height {} m",
                                                       shown(base), shown(axis), base_radius, top_radius, height));
}

}  // namespace stirsph
