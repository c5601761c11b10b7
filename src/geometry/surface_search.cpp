#include "geometry/surface_search.hpp"

#include <numeric>

namespace stirsph {
namespace {

Bounds around(const Vec3* points, int count) {
  Bounds box{points[0], points[0]};
  for (int k = 1; k < count; ++k)
    for (int i = 0; i < 3; ++i) {
      box.low[i] = std::min(box.low[i], points[k][i]);
      box.high[i] = std::max(box.high[i], points[k][i]);
    }
  return box;
}

/// Share of the end b in the point of the edge from a to b nearest to p.
double along_edge(const Vec3& a, const Vec3& b, const Vec3& p) {
  const Vec3 edge = b - a;
  const double squared = dot(edge, edge);
  return squared > 0 ? std::clamp(dot(p - a, edge) / squared, 0.0, 1.0) : 0.0;
}

struct Candidate {
  std::array<double, 3> weights;
  Vec3 point;
  double squared;
};

Candidate on_edge(const std::array<Vec3, 3>& c, int from, int to, const Vec3& p) {
  const double share = along_edge(c[from], c[to], p);
  Candidate result{};
  result.weights[from] = 1 - share;
  result.weights[to] = share;
  result.point = (1 - share) * c[from] + share * c[to];
  result.squared = dot(p - result.point, p - result.point);
  return result;
}

/// The foot of the perpendicular when it falls into the triangle, otherwise the nearest point of the three edges.
Candidate on_triangle(const std::array<Vec3, 3>& c, const Vec3& p) {
  const Vec3 u = c[1] - c[0], v = c[2] - c[0], normal = cross(u, v), offset = p - c[0];
  const double squared_area = dot(normal, normal);
  if (squared_area > 0) {
    const double second = dot(cross(offset, v), normal) / squared_area;
    const double third = dot(cross(u, offset), normal) / squared_area;
    const double first = 1 - second - third;
    if (first >= 0 && second >= 0 && third >= 0) {
      const Vec3 point = first * c[0] + second * c[1] + third * c[2];
      const double height = dot(offset, normal);
      return {{first, second, third}, point, height * height / squared_area};
    }
  }
  Candidate best = on_edge(c, 0, 1, p);
  for (const auto& other : {on_edge(c, 1, 2, p), on_edge(c, 2, 0, p)})
    if (other.squared < best.squared) best = other;
  return best;
}

}  // namespace

BoxTree::BoxTree(const std::vector<Bounds>& boxes) : items_(boxes.size()) {
  if (boxes.empty()) return;
  std::iota(items_.begin(), items_.end(), 0);
  branches_.reserve(boxes.size());
  branches_.emplace_back();
  fill(0, 0, static_cast<std::int32_t>(boxes.size()), boxes);
}

void BoxTree::fill(std::int32_t branch, std::int32_t first, std::int32_t size, const std::vector<Bounds>& boxes) {
  constexpr std::int32_t leaf = 4;
  Bounds box = boxes[items_[first]], centres{box.low + box.high, box.low + box.high};  // twice the centres
  for (std::int32_t k = first; k < first + size; ++k)
    for (int i = 0; i < 3; ++i) {
      const Bounds& item = boxes[items_[k]];
      box.low[i] = std::min(box.low[i], item.low[i]);
      box.high[i] = std::max(box.high[i], item.high[i]);
      centres.low[i] = std::min(centres.low[i], item.low[i] + item.high[i]);
      centres.high[i] = std::max(centres.high[i], item.low[i] + item.high[i]);
    }
  branches_[branch] = {box.low, box.high, first, size};
  if (size <= leaf) return;
  const Vec3 spread = centres.high - centres.low;
  const int axis = spread.x >= spread.y && spread.x >= spread.z ? 0 : spread.y >= spread.z ? 1 : 2;
  const std::int32_t half = size / 2;
  const auto begin = items_.begin() + first;
  std::nth_element(begin, begin + half, begin + size, [&](std::int32_t a, std::int32_t b) {
    const double left = boxes[a].low[axis] + boxes[a].high[axis], right = boxes[b].low[axis] + boxes[b].high[axis];
    return left != right ? left < right : a < b;
  });
  const auto children = static_cast<std::int32_t>(branches_.size());
  branches_[branch].first = children;
  branches_[branch].size = 0;
  branches_.resize(branches_.size() + 2);
  fill(children, first, half, boxes);
  fill(children + 1, first + half, size - half, boxes);
}

SurfaceSearch::SurfaceSearch(const SimplexMesh& mesh) : dim_(mesh.dim), axisymmetric_(mesh.axisymmetric) {
  std::vector<std::int32_t> all(mesh.surface.size());
  std::iota(all.begin(), all.end(), 0);
  build(mesh, all);
}

SurfaceSearch::SurfaceSearch(const SimplexMesh& mesh, const SurfaceGroup& group)
    : dim_(mesh.dim), axisymmetric_(mesh.axisymmetric) {
  build(mesh, group.facets);
}

void SurfaceSearch::build(const SimplexMesh& mesh, const std::vector<std::int32_t>& facets) {
  std::vector<Bounds> boxes;
  for (const auto index : facets) {
    Facet facet{{}, index};
    for (int i = 0; i < dim_; ++i) facet.corners[i] = mesh.nodes[mesh.surface[index][i]];
    boxes.push_back(around(facet.corners.data(), dim_));
    facets_.push_back(facet);
  }
  tree_ = BoxTree(boxes);
}

SurfacePlace SurfaceSearch::nearest(const Vec3& place, double radius) const {
  const Vec3 point = axisymmetric_ ? turned_into_half_plane(place) : place;
  SurfacePlace best;
  double squared = radius * radius;
  tree_.near(point, squared, [&](std::int32_t item) {
    const Facet& facet = facets_[item];
    const Candidate found = dim_ == 2 ? on_edge(facet.corners, 0, 1, point) : on_triangle(facet.corners, point);
    if (found.squared > squared || (found.squared == squared && best.facet >= 0 && facet.index > best.facet)) return;
    squared = found.squared;
    best = {facet.index, found.weights, found.point, 0};
  });
  best.distance = best.facet >= 0 ? std::sqrt(squared) : std::numeric_limits<double>::infinity();
  return best;
}

ElementSearch::ElementSearch(const SimplexMesh& mesh) : corners_(mesh.corners()), axisymmetric_(mesh.axisymmetric) {
  std::vector<Bounds> boxes;
  for (std::size_t e = 0; e < mesh.elements.size(); ++e) {
    std::array<Vec3, 4> nodes{};
    for (int i = 0; i < corners_; ++i) nodes[i] = mesh.nodes[mesh.elements[e][i]];
    boxes.push_back(around(nodes.data(), corners_));
    gradients_.push_back(shape_gradients(mesh, e));
    first_nodes_.push_back(nodes[0]);
  }
  tree_ = BoxTree(boxes);
}

VolumePlace ElementSearch::find(const Vec3& place) const {
  const Vec3 point = axisymmetric_ ? turned_into_half_plane(place) : place;
  constexpr double rounding = 1e-9;  // of a weight
  VolumePlace best;
  double most = -rounding;
  // Boxes are met exactly or not at all, so rounding is allowed for by a radius far below any element.
  double squared = 1e-24;
  tree_.near(point, squared, [&](std::int32_t element) {
    const Vec3 offset = point - first_nodes_[element];
    std::array<double, 4> weights{1, 0, 0, 0};
    for (int i = 1; i < corners_; ++i) weights[i] = dot(gradients_[element][i], offset);
    weights[0] = 1 - weights[1] - weights[2] - weights[3];
    const double least = *std::min_element(weights.begin(), weights.begin() + corners_);
    if (least < most || (least == most && element > best.element)) return;
    most = least;
    best = {element, weights};
  });
  return best;
}

}  // namespace stirsph
