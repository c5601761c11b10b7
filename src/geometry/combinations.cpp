#include "geometry/combinations.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "base/error.hpp"

namespace stirsph {
namespace {

SurfacePoint flipped(const SurfacePoint& p) { return {-p.distance, -p.normal}; }

/// Distance to the intersection of two solids from the distances to each, in their tangent planes.
SurfacePoint meet(const SurfacePoint& a, const SurfacePoint& b) {
  const SurfacePoint& farther = a.distance >= b.distance ? a : b;
  const SurfacePoint& closer = a.distance >= b.distance ? b : a;
  const double cosine = dot(a.normal, b.normal);
  // Inside one of them, or the foot on the farther plane lies within the other solid: that plane decides.
  if (closer.distance <= 0 || cosine * farther.distance >= closer.distance) return farther;
  const double determinant = 1 - cosine * cosine;
  if (determinant < 1e-6) return farther;  // opposite faces: no edge to speak of
  // The foot on the edge is -(u n_a + v n_b) with n_a.foot = -d_a and n_b.foot = -d_b.
  const double u = (a.distance - cosine * b.distance) / determinant;
  const double v = (b.distance - cosine * a.distance) / determinant;
  const Vec3 towards = u * a.normal + v * b.normal;
  const double distance = norm(towards);
  return distance > 0 ? SurfacePoint{distance, towards / distance} : farther;
}

constexpr std::size_t most_members = 16;  // of one combination: on the stack, because nearest() runs per contact pair

/// Distance to the intersection of `count` solids; member(i) gives the distance to each.
template <class Member>
SurfacePoint intersect(std::size_t count, Member member) {
  std::array<SurfacePoint, most_members> points;
  std::size_t farthest = 0;
  for (std::size_t i = 0; i < count; ++i) {
    points[i] = member(i);
    if (points[i].distance > points[farthest].distance) farthest = i;
  }
  SurfacePoint result = points[farthest];
  if (result.distance <= 0) return result;
  for (std::size_t i = 0; i < count; ++i)
    for (std::size_t j = i + 1; j < count; ++j) {
      if (points[i].distance <= 0 || points[j].distance <= 0) continue;
      const SurfacePoint edge = meet(points[i], points[j]);
      if (edge.distance > result.distance) result = edge;
    }
  return result;
}

void check_members(const std::vector<ShapePointer>& members, const char* name) {
  if (members.empty() || members.size() >= most_members)
    throw InputError(std::string(name) + " of " + std::to_string(members.size()) + " shapes. Allowed: 1 to " +
                     std::to_string(most_members - 1) + "; nest combinations for more");
}

std::string listed(const std::vector<ShapePointer>& members) {
  std::string text;
  for (const auto& member : members) text += (text.empty() ? "" : "; ") + member->describe();
  return "[" + text + "]";
}

}  // namespace

Intersection::Intersection(std::vector<ShapePointer> members) : members_(std::move(members)) {
  check_members(members_, "intersection");
}

SurfacePoint Intersection::nearest(const Vec3& point) const {
  return intersect(members_.size(), [&](std::size_t i) { return members_[i]->nearest(point); });
}

Bounds Intersection::bounds() const {
  Bounds result = members_.front()->bounds();
  for (const auto& member : members_) {
    const Bounds other = member->bounds();
    for (int i = 0; i < 3; ++i) {
      result.low[i] = std::max(result.low[i], other.low[i]);
      result.high[i] = std::min(result.high[i], other.high[i]);
    }
  }
  return result;
}

std::string Intersection::describe() const { return "intersection of " + listed(members_); }

Union::Union(std::vector<ShapePointer> members) : members_(std::move(members)) { check_members(members_, "union"); }

SurfacePoint Union::nearest(const Vec3& point) const {
  // What lies outside a union lies outside all members: the complement is an intersection of complements.
  return flipped(intersect(members_.size(), [&](std::size_t i) { return flipped(members_[i]->nearest(point)); }));
}

Bounds Union::bounds() const {
  Bounds result = members_.front()->bounds();
  for (const auto& member : members_) {
    const Bounds other = member->bounds();
    for (int i = 0; i < 3; ++i) {
      result.low[i] = std::min(result.low[i], other.low[i]);
      result.high[i] = std::max(result.high[i], other.high[i]);
    }
  }
  return result;
}

std::string Union::describe() const { return "union of " + listed(members_); }

Difference::Difference(ShapePointer shape, std::vector<ShapePointer> removed)
    : shape_(std::move(shape)), removed_(std::move(removed)) {
  check_members(removed_, "difference");
}

SurfacePoint Difference::nearest(const Vec3& point) const {
  return intersect(removed_.size() + 1, [&](std::size_t i) {
    return i == 0 ? shape_->nearest(point) : flipped(removed_[i - 1]->nearest(point));
  });
}

std::string Difference::describe() const { return shape_->describe() + " without " + listed(removed_); }

}  // namespace stirsph
