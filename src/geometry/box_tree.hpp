/// A tree of axis-aligned boxes, to find what is near a point.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "geometry/shape.hpp"

namespace stirsph {

class BoxTree {
 public:
  BoxTree() = default;
  /// Boxes around the items, which are known by their index.
  explicit BoxTree(const std::vector<Bounds>& boxes);

  /// Calls look(item) for every item whose box might lie within sqrt(squared_radius) of the point, near ones early.
  /// look may lower squared_radius as it finds better ones [m2].
  template <class Look>
  void near(const Vec3& point, double& squared_radius, Look look) const {
    if (branches_.empty()) return;
    std::array<std::int32_t, 64> waiting;  // depth is log2 of the number of items: halves are equal
    int count = 0;
    waiting[count++] = 0;
    while (count > 0) {
      const Branch& branch = branches_[waiting[--count]];
      if (!(squared_distance(branch, point) <= squared_radius)) continue;
      if (branch.size > 0) {
        for (std::int32_t i = 0; i < branch.size; ++i) look(items_[branch.first + i]);
        continue;
      }
      const std::int32_t left = branch.first, right = branch.first + 1;
      const bool left_first = squared_distance(branches_[left], point) <= squared_distance(branches_[right], point);
      waiting[count++] = left_first ? right : left;
      waiting[count++] = left_first ? left : right;
    }
  }

 private:
  struct Branch {
    Vec3 low, high;
    std::int32_t first = 0;  ///< of its items, or the first of its two branches
    std::int32_t size = 0;   ///< number of items; 0: it has branches
  };
  void fill(std::int32_t branch, std::int32_t first, std::int32_t size, const std::vector<Bounds>& boxes);

  static double squared_distance(const Branch& b, const Vec3& p) {
    const double dx = std::max({b.low.x - p.x, 0.0, p.x - b.high.x}),
                 dy = std::max({b.low.y - p.y, 0.0, p.y - b.high.y}),
                 dz = std::max({b.low.z - p.z, 0.0, p.z - b.high.z});
    return dx * dx + dy * dy + dz * dz;
  }

  std::vector<Branch> branches_;
  std::vector<std::int32_t> items_;
};

}  // namespace stirsph
