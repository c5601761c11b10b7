#include "geometry/revolved_profile.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include <fmt/format.h>

#include "base/error.hpp"
#include "geometry/about_axis.hpp"

namespace stirsph {
namespace {

using Vertex = RevolvedProfile::Vertex;
using Edge = RevolvedProfile::Edge;

constexpr double infinity = std::numeric_limits<double>::infinity();

/// A vertex of the profile with its place in the input, which reversing the order must not lose.
struct Corner {
  Vertex at;
  std::size_t number;
};

[[noreturn]] void refuse(const Corner& corner, const std::string& why) {
  throw InputError(fmt::format("vertex {} (r = {:.6g} mm, z = {:.6g} mm): {}", corner.number, 1e3 * corner.at.r,
                               1e3 * corner.at.z, why));
}

/// Twice the signed area of the triangle a b c; positive when they turn counter-clockwise.
double turn(const Vertex& a, const Vertex& b, const Vertex& c) {
  return (b.r - a.r) * (c.z - a.z) - (b.z - a.z) * (c.r - a.r);
}

bool same_place(const Vertex& a, const Vertex& b) { return a.r == b.r && a.z == b.z; }

bool within(const Vertex& a, const Vertex& b, const Vertex& p) {
  return std::min(a.r, b.r) <= p.r && p.r <= std::max(a.r, b.r) && std::min(a.z, b.z) <= p.z &&
         p.z <= std::max(a.z, b.z);
}

/// Do the lines a-b and c-d have a point in common?
bool meet(const Vertex& a, const Vertex& b, const Vertex& c, const Vertex& d) {
  const double abc = turn(a, b, c), abd = turn(a, b, d), cda = turn(c, d, a), cdb = turn(c, d, b);
  if (((abc > 0) != (abd > 0)) && ((cda > 0) != (cdb > 0)) && abc != 0 && abd != 0 && cda != 0 && cdb != 0) return true;
  return (abc == 0 && within(a, b, c)) || (abd == 0 && within(a, b, d)) || (cda == 0 && within(c, d, a)) ||
         (cdb == 0 && within(c, d, b));
}

/// Corners counter-clockwise, after refusing what bounds no solid.
std::vector<Corner> checked(const std::vector<Vertex>& vertices) {
  const std::size_t count = vertices.size();
  if (count < 3) throw InputError(fmt::format("a profile of {} vertices. Allowed: at least 3", count));
  std::vector<Corner> corners;
  for (std::size_t i = 0; i < count; ++i) corners.push_back({vertices[i], i});
  double area = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const Vertex &v = vertices[i], &next = vertices[(i + 1) % count];
    const Corner& corner = corners[i];
    if (!std::isfinite(v.r) || !std::isfinite(v.z)) refuse(corner, "not a finite place");
    if (v.r < 0) refuse(corner, "the radius must be >= 0");
    if (v.fillet < 0) refuse(corner, "the fillet radius must be >= 0");
    if (v.fillet > 0 && v.r == 0) refuse(corner, "a vertex on the axis cannot be rounded. Leave its fillet out");
    if (same_place(v, next))
      refuse(corner, "the next vertex is the same place. Give each vertex once; the last is joined to the first");
    area += v.r * next.z - next.r * v.z;
  }
  for (std::size_t i = 0; i < count; ++i)
    for (std::size_t j = i + 1; j < count; ++j) {
      const Vertex &a = vertices[i], &b = vertices[(i + 1) % count], &c = vertices[j], &d = vertices[(j + 1) % count];
      const std::string after = fmt::format("the line from here and the line from vertex {} ", j);
      if (j == i + 1 || (i == 0 && j == count - 1)) {
        // Neighbours share a vertex; they must not fold back onto each other.
        const Vertex &shared = j == i + 1 ? b : a, &first = j == i + 1 ? a : c, &last = j == i + 1 ? d : b;
        const double along = (first.r - shared.r) * (last.r - shared.r) + (first.z - shared.z) * (last.z - shared.z);
        if (turn(first, shared, last) == 0 && along > 0) refuse(corners[i], after + "lie on each other");
      } else if (meet(a, b, c, d)) {
        refuse(corners[i],
               after + "cross or touch. A profile must not cross itself: give the vertices in order around it");
      }
    }
  if (area < 0) std::reverse(corners.begin(), corners.end());
  return corners;
}

/// A corner as it is built: where the fillet begins and ends; both are the vertex itself when it is sharp.
struct Rounded {
  Vertex begin, end;
  double angle = 0;  ///< rad by which the profile turns here, positive to the left (convex)
};

double tangent_length(double fillet, double angle) { return fillet * std::tan(0.5 * std::abs(angle)); }

double turning_angle(const Vertex& before, const Vertex& here, const Vertex& after) {
  const double ar = here.r - before.r, az = here.z - before.z, br = after.r - here.r, bz = after.z - here.z;
  return std::atan2(ar * bz - az * br, ar * br + az * bz);
}

Vertex towards(const Vertex& from, const Vertex& to, double distance) {
  const double length = std::hypot(to.r - from.r, to.z - from.z);
  if (std::abs(distance - length) <= 1e-12 * length) return {to.r, to.z};  // a fillet that uses the whole line
  return {from.r + distance * (to.r - from.r) / length, from.z + distance * (to.z - from.z) / length};
}

std::vector<Rounded> rounded(const std::vector<Corner>& corners) {
  const std::size_t count = corners.size();
  const auto vertex = [&](std::size_t i) -> const Vertex& { return corners[i % count].at; };
  std::vector<Rounded> result;
  std::vector<double> used;  // of the lines on both sides of each vertex
  for (std::size_t i = 0; i < count; ++i) {
    const Vertex &before = vertex(i + count - 1), &here = vertex(i), &after = vertex(i + 1);
    const double angle = turning_angle(before, here, after);
    used.push_back(tangent_length(here.fillet, angle));
    result.push_back({towards(here, before, used[i]), towards(here, after, used[i]), used[i] > 0 ? angle : 0});
    if (used[i] == 0) result[i].begin = result[i].end = here;
  }
  for (std::size_t i = 0; i < count; ++i) {
    const Vertex &here = vertex(i), &after = vertex(i + 1);
    const std::size_t next = (i + 1) % count;
    const double length = std::hypot(after.r - here.r, after.z - here.z);
    if (used[i] + used[next] > length * (1 + 1e-12)) {
      const Corner& larger = corners[used[i] >= used[next] ? i : next];
      refuse(larger,
             fmt::format("the fillet of {:.6g} mm is too large: with its neighbour it takes {:.6g} mm of a line of "
                         "{:.6g} mm",
                         1e3 * larger.at.fillet, 1e3 * (used[i] + used[next]), 1e3 * length));
    }
    if (used[i] == 0) continue;
    // Whatever else reaches into the corner that the fillet cuts off comes in across its chord. A fillet that uses up a
    // line ends where the next one begins, which is no crossing.
    for (std::size_t j = 0; j < count; ++j) {
      const std::size_t end = (j + 1) % count;
      if (j == i || end == i || (j == next && same_place(result[i].end, after)) ||
          (end == (i + count - 1) % count && same_place(result[i].begin, vertex(end))))
        continue;
      if (meet(result[i].begin, result[i].end, vertex(j), vertex(end)))
        refuse(corners[i], fmt::format("the fillet of {:.6g} mm is too large: it reaches the line from vertex {}",
                                       1e3 * here.fillet, corners[j].number));
    }
  }
  return result;
}

void add_line(std::vector<Edge>& edges, const Vertex& a, const Vertex& b) {
  const double length = std::hypot(b.r - a.r, b.z - a.z);
  if (length == 0) return;  // two fillets that meet
  edges.push_back({.start_r = a.r,
                   .start_z = a.z,
                   .end_r = b.r,
                   .end_z = b.z,
                   .dr = (b.r - a.r) / length,
                   .dz = (b.z - a.z) / length,
                   .length = length,
                   .is_surface = a.r > 0 || b.r > 0});
}

/// The arc of a fillet, cut where it turns back in z, so that a line z = const crosses each piece at most once.
void add_arc(std::vector<Edge>& edges, const Rounded& corner, double radius) {
  const Vertex &a = corner.begin, &b = corner.end;
  const double side = corner.angle > 0 ? 1 : -1, half = 0.5 * std::abs(corner.angle);
  const double chord_r = b.r - a.r, chord_z = b.z - a.z, chord = std::hypot(chord_r, chord_z);
  // The centre lies to the left of the chord for a convex corner, to the right for a concave one.
  const double centre_r = 0.5 * (a.r + b.r) - side * radius * std::cos(half) * chord_z / chord;
  const double centre_z = 0.5 * (a.z + b.z) + side * radius * std::cos(half) * chord_r / chord;
  const double first = std::atan2(a.z - centre_z, a.r - centre_r), last = first + corner.angle;
  std::vector<double> cuts{first};
  for (int k = -3; k <= 3; ++k) {
    const double pole = (0.5 + k) * std::numbers::pi;  // where the circle is lowest or highest
    if (std::min(first, last) + 1e-9 < pole && pole < std::max(first, last) - 1e-9) cuts.push_back(pole);
  }
  cuts.push_back(last);
  if (side < 0) std::sort(cuts.begin() + 1, cuts.end() - 1, std::greater<>());
  for (std::size_t c = 0; c + 1 < cuts.size(); ++c) {
    const auto place = [&](std::size_t k) -> Vertex {
      if (k == 0) return a;
      if (k + 1 == cuts.size()) return b;
      return {centre_r + radius * std::cos(cuts[k]), centre_z + radius * std::sin(cuts[k])};
    };
    const Vertex start = place(c), end = place(c + 1);
    const double middle = 0.5 * (cuts[c] + cuts[c + 1]);
    edges.push_back({.start_r = start.r,
                     .start_z = start.z,
                     .end_r = end.r,
                     .end_z = end.z,
                     .dr = 0,
                     .dz = 0,
                     .length = std::hypot(end.r - start.r, end.z - start.z),
                     .is_surface = true,
                     .radius = radius,
                     .centre_r = centre_r,
                     .centre_z = centre_z,
                     .middle_r = std::cos(middle),
                     .middle_z = std::sin(middle),
                     .cos_half = std::cos(0.5 * (cuts[c + 1] - cuts[c])),
                     .outward = side});
  }
}

/// The nearest point of an edge, seen from a point.
struct Foot {
  double to_r, to_z;          ///< from the foot to the point
  double normal_r, normal_z;  ///< outward, of the edge at the foot
};

Foot foot_on_line(const Edge& e, double r, double z) {
  const double pr = r - e.start_r, pz = z - e.start_z;
  const double along = std::clamp(pr * e.dr + pz * e.dz, 0.0, e.length);
  return {pr - along * e.dr, pz - along * e.dz, e.dz, -e.dr};
}

Foot foot_on_arc(const Edge& e, double r, double z) {
  const double pr = r - e.centre_r, pz = z - e.centre_z, d = std::sqrt(pr * pr + pz * pz);
  if (pr * e.middle_r + pz * e.middle_z >= d * e.cos_half) {
    // The centre itself is as far from all of the arc: its middle is taken.
    const double ur = d > 0 ? pr / d : e.middle_r, uz = d > 0 ? pz / d : e.middle_z;
    return {(d - e.radius) * ur, (d - e.radius) * uz, e.outward * ur, e.outward * uz};
  }
  const double start_r = r - e.start_r, start_z = z - e.start_z, end_r = r - e.end_r, end_z = z - e.end_z;
  const bool at_start = start_r * start_r + start_z * start_z < end_r * end_r + end_z * end_z;
  const double foot_r = at_start ? e.start_r : e.end_r, foot_z = at_start ? e.start_z : e.end_z;
  return {r - foot_r, z - foot_z, e.outward * (foot_r - e.centre_r) / e.radius,
          e.outward * (foot_z - e.centre_z) / e.radius};
}

/// Does a ray from the point towards larger r cross the edge? Half-open in z, so that a shared end counts once.
bool crosses(const Edge& e, double r, double z) {
  if ((e.start_z > z) == (e.end_z > z)) return false;
  if (e.radius == 0) return r - e.start_r < e.dr / e.dz * (z - e.start_z);
  const double height = z - e.centre_z, reach = std::sqrt(std::max(0.0, e.radius * e.radius - height * height));
  return r < e.centre_r + std::copysign(reach, e.middle_r);
}

}  // namespace

RevolvedProfile::RevolvedProfile(const Vec3& base, const Vec3& axis, std::vector<Vertex> vertices,
                                 std::string description)
    : base_(base), axis_(unit_axis(axis)), description_(std::move(description)) {
  const std::vector<Corner> corners = checked(vertices);
  const std::vector<Rounded> built = rounded(corners);
  for (std::size_t i = 0; i < built.size(); ++i) {
    if (built[i].angle != 0) add_arc(edges_, built[i], corners[i].at.fillet);
    add_line(edges_, built[i].end, built[(i + 1) % built.size()].begin);
  }
}

SurfacePoint RevolvedProfile::nearest(const Vec3& point) const {
  const auto [r, z, radial] = about(base_, axis_, point);
  double closest = infinity, length = 0;
  Foot nearest_foot{};
  bool inside = false;
  for (const Edge& edge : edges_) {
    if (crosses(edge, r, z)) inside = !inside;
    if (!edge.is_surface) continue;
    const Foot foot = edge.radius == 0 ? foot_on_line(edge, r, z) : foot_on_arc(edge, r, z);
    const double squared = foot.to_r * foot.to_r + foot.to_z * foot.to_z;
    if (squared < closest) {
      closest = squared;
      nearest_foot = foot;
      length = edge.length;
    }
  }
  const double distance = std::sqrt(closest), sign = inside ? -1 : 1;
  double normal_r = nearest_foot.normal_r, normal_z = nearest_foot.normal_z;
  // On the surface itself rounding decides about the direction: keep the edge's own normal there.
  const double on_surface = 1e-12 * (std::abs(r) + std::abs(z) + length);
  if (distance > on_surface) {
    normal_r = sign * nearest_foot.to_r / distance;
    normal_z = sign * nearest_foot.to_z / distance;
  }
  return {sign * distance, normal_r * radial + normal_z * axis_};
}

double RevolvedProfile::support(double along_r, double along_z) const {
  const double size = std::hypot(along_r, along_z);
  double result = -infinity;
  for (const Edge& e : edges_) {
    result = std::max({result, e.start_r * along_r + e.start_z * along_z, e.end_r * along_r + e.end_z * along_z});
    if (e.radius > 0 && along_r * e.middle_r + along_z * e.middle_z >= size * e.cos_half)
      result = std::max(result, e.centre_r * along_r + e.centre_z * along_z + e.radius * size);
  }
  return result;
}

Bounds RevolvedProfile::bounds() const {
  Bounds result;
  for (int i = 0; i < 3; ++i) {
    result.low[i] = base_[i] - support(disc_reach(axis_, i), -axis_[i]);
    result.high[i] = base_[i] + support(disc_reach(axis_, i), axis_[i]);
  }
  return result;
}

ShapePointer make_tool(const Vec3& base, const Vec3& axis, double radius, double land, double relief, double height,
                       double edge_fillet) {
  std::vector<Vertex> vertices{{0, 0}, {radius, 0, edge_fillet}};
  if (relief > 0) {
    vertices.push_back({radius, land});
    vertices.push_back({radius - relief, land});
  }
  vertices.push_back({radius - relief, height});
  if (relief < radius) vertices.push_back({0, height});
  return std::make_shared<RevolvedProfile>(
      base, axis, std::move(vertices),
      fmt::format("tool, face at {} m, axis {}, radius {} m, land {} m, relief {} m, height {} m, edge fillet {} m",
                  shown(base), shown(axis), radius, land, relief, height, edge_fillet));
}

ShapePointer make_die(const Vec3& base, const Vec3& axis, double inner_radius, double outer_radius, double height,
                      double taper, double edge_fillet) {
  const double top = inner_radius + height * std::tan(taper);
  return std::make_shared<RevolvedProfile>(
      base, axis,
      std::vector<Vertex>{{inner_radius, 0}, {outer_radius, 0}, {outer_radius, height}, {top, height, edge_fillet}},
      fmt::format("die, base {} m, axis {}, bore radius {} m to {} m, outer radius {} m, height {} m, edge fillet {} m",
                  shown(base), shown(axis), inner_radius, top, outer_radius, height, edge_fillet));
}

}  // namespace stirsph
