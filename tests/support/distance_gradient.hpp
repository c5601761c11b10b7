/// Gradients of signed distances by central differences.
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>
#include <random>
#include <vector>

#include "geometry/shape.hpp"

namespace stirsph::testing {

/// Points spread evenly over the cube |x|, |y|, |z| < half_width.
inline std::vector<Vec3> random_points(int count, double half_width, unsigned seed) {
  std::mt19937 generator(seed);
  std::uniform_real_distribution<double> along(-half_width, half_width);
  std::vector<Vec3> points(count);
  for (auto& p : points) p = {along(generator), along(generator), along(generator)};
  return points;
}

/// At p; nothing where it has a kink, a point with several nearest surface points.
inline std::optional<Vec3> distance_gradient(const ShapeFunction& shape, const Vec3& p) {
  const double step = 1e-6, at = shape.distance(p);
  Vec3 gradient;
  double kink = 0;
  for (int i = 0; i < 3; ++i) {
    Vec3 forth = p, back = p;
    forth[i] += step;
    back[i] -= step;
    gradient[i] = (shape.distance(forth) - shape.distance(back)) / (2 * step);
    kink = std::max(kink, std::abs(shape.distance(forth) + shape.distance(back) - 2 * at));
  }
  if (kink > 1e-9) return std::nullopt;
  return gradient;
}

}  // namespace stirsph::testing
