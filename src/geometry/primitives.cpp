#include "geometry/primitives.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "base/error.hpp"

namespace stirsph {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

std::string shown(const Vec3& v) { return fmt::format("({}, {}, {})", v.x, v.y, v.z); }

/// A unit vector across the axis; x for the axes y and z, so that shapes in the plane z = 0 keep their normals in it.
Vec3 across(const Vec3& axis) {
  const Vec3 candidate = std::abs(axis.x) < 0.9 ? Vec3{1, 0, 0} : Vec3{0, 1, 0};
  return normalised(candidate - dot(candidate, axis) * axis);
}

/// Coordinates of a point about an axis.
struct Cylindrical {
  double r, z;
  Vec3 radial;  ///< unit vector
};
Cylindrical about(const Vec3& base, const Vec3& axis, const Vec3& point) {
  const Vec3 offset = point - base;
  const double z = dot(offset, axis);
  const Vec3 radial = offset - z * axis;
  const double r = norm(radial);
  return {r, z, r > 0 ? radial / r : across(axis)};
}

/// How far a unit disc across the axis reaches along coordinate i.
double disc_reach(const Vec3& axis, int i) { return std::sqrt(std::max(0.0, 1 - axis[i] * axis[i])); }

void expect(bool condition, const char* message) {
  if (!condition) throw InputError(message);
}

Vec3 unit_axis(const Vec3& axis) {
  expect(norm(axis) > 0 && std::isfinite(norm(axis)), "the axis or normal of a shape must have a finite length > 0");
  return normalised(axis);
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

RevolvedPolygon::RevolvedPolygon(const Vec3& base, const Vec3& axis, const std::vector<Corner>& corners,
                                 std::string description)
    : base_(base), axis_(unit_axis(axis)), description_(std::move(description)) {
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Corner a = corners[i], b = corners[(i + 1) % corners.size()];
    const double length = std::hypot(b.r - a.r, b.z - a.z);
    if (length > 0) edges_.push_back({a, (b.r - a.r) / length, (b.z - a.z) / length, length, a.r > 0 || b.r > 0});
  }
  expect(edges_.size() >= 3, "a turned shape needs radii and a height > 0");
}

SurfacePoint RevolvedPolygon::nearest(const Vec3& point) const {
  const auto [r, z, radial] = about(base_, axis_, point);
  double closest = infinity, to_r = 0, to_z = 0;
  const Edge* nearest_edge = nullptr;
  bool inside = false;
  for (const Edge& edge : edges_) {
    const double pr = r - edge.start.r, pz = z - edge.start.z;
    // Crossing number of the ray towards larger r; half-open in z so that a corner counts once.
    const double end_z = edge.start.z + edge.dz * edge.length;
    if ((edge.start.z > z) != (end_z > z) && pr < edge.dr / edge.dz * pz) inside = !inside;
    if (!edge.is_surface) continue;
    const double along = std::clamp(pr * edge.dr + pz * edge.dz, 0.0, edge.length);
    const double dr = pr - along * edge.dr, dz = pz - along * edge.dz, squared = dr * dr + dz * dz;
    if (squared < closest) {
      closest = squared;
      to_r = dr;
      to_z = dz;
      nearest_edge = &edge;
    }
  }
  const double distance = std::sqrt(closest);
  double normal_r = nearest_edge->dz, normal_z = -nearest_edge->dr;  // outward: to the right of the direction
  const double sign = inside ? -1 : 1;
  // On the surface itself rounding decides about the direction: keep the edge's own normal there.
  const double on_surface = 1e-12 * (std::abs(r) + std::abs(z) + nearest_edge->length);
  if (distance > on_surface) {
    normal_r = sign * to_r / distance;
    normal_z = sign * to_z / distance;
  }
  return {sign * distance, normal_r * radial + normal_z * axis_};
}

Bounds RevolvedPolygon::bounds() const {
  Bounds result{{infinity, infinity, infinity}, {-infinity, -infinity, -infinity}};
  for (const Edge& edge : edges_)
    for (int i = 0; i < 3; ++i) {
      const double middle = base_[i] + edge.start.z * axis_[i], reach = edge.start.r * disc_reach(axis_, i);
      result.low[i] = std::min(result.low[i], middle - reach);
      result.high[i] = std::max(result.high[i], middle + reach);
    }
  return result;
}

std::vector<RevolvedPolygon::Corner> RevolvedPolygon::corners() const {
  std::vector<Corner> result;
  for (const Edge& edge : edges_) result.push_back(edge.start);
  return result;
}

ShapePointer make_cylinder(const Vec3& base, const Vec3& axis, double radius, std::optional<double> height) {
  expect(radius > 0, "the radius of a cylinder must be > 0");
  if (!height || *height == infinity) return std::make_shared<EndlessTube>(base, axis, 0.0, radius);
  expect(*height > 0, "the height of a cylinder must be > 0");
  return std::make_shared<RevolvedPolygon>(
      base, axis, std::vector<RevolvedPolygon::Corner>{{0, 0}, {radius, 0}, {radius, *height}, {0, *height}},
      fmt::format("cylinder, base {} m, axis {}, radius {} m, height {} m", shown(base), shown(axis), radius, *height));
}

ShapePointer make_annulus(const Vec3& base, const Vec3& axis, double inner_radius, double outer_radius,
                          std::optional<double> height) {
  expect(inner_radius > 0 && outer_radius > inner_radius, "the radii of an annulus must satisfy 0 < inner < outer");
  if (!height || *height == infinity) return std::make_shared<EndlessTube>(base, axis, inner_radius, outer_radius);
  expect(*height > 0, "the height of an annulus must be > 0");
  return std::make_shared<RevolvedPolygon>(
      base, axis,
      std::vector<RevolvedPolygon::Corner>{
          {inner_radius, 0}, {outer_radius, 0}, {outer_radius, *height}, {inner_radius, *height}},
      fmt::format("annulus, base {} m, axis {}, inner radius {} m, outer radius {} m, height {} m", shown(base),
                  shown(axis), inner_radius, outer_radius, *height));
}

ShapePointer make_frustum(const Vec3& base, const Vec3& axis, double base_radius, double top_radius, double height) {
  expect(height > 0 && base_radius >= 0 && top_radius >= 0 && base_radius + top_radius > 0,
         "a frustum needs a height > 0, radii >= 0 and one radius > 0");
  return std::make_shared<RevolvedPolygon>(
      base, axis, std::vector<RevolvedPolygon::Corner>{{0, 0}, {base_radius, 0}, {top_radius, height}, {0, height}},
      fmt::format("frustum, base {} m, axis {}, radii {} m and {} m, height {} m", shown(base), shown(axis),
                  base_radius, top_radius, height));
}

}  // namespace stirsph
