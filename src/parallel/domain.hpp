/// The periodic box, planes of symmetry and the axis of symmetry, if any. Directions that are not periodic are
/// unbounded.
#pragma once

#include <array>
#include <cmath>

#include "base/tensor.hpp"

namespace stirsph {

struct Domain {
  int dim = 3;
  std::array<bool, 3> periodic{};
  Vec3 low, high;                   ///< m; used in periodic directions only
  std::array<bool, 3> symmetric{};  ///< the metal lies above `plane` in these directions, its mirror image below
  Vec3 plane{};                     ///< m
  bool axis =
      false;  ///< the first coordinate is a distance from an axis: beyond it lie particles turned by half a turn

  double length(int d) const { return high[d] - low[d]; }
  /// Whether there are images beyond `plane` in this direction; at an axis that is 0.
  bool mirrors(int d) const { return symmetric[d] || (axis && d == 0); }
  bool any_symmetric() const { return symmetric[0] || symmetric[1] || symmetric[2]; }
  bool any_images() const { return any_periodic() || any_symmetric() || axis; }
  bool any_periodic() const { return periodic[0] || periodic[1] || periodic[2]; }
  /// The image of x inside the box.
  double wrap(double x, int d) const {
    if (!periodic[d]) return x;
    const double turns = std::floor((x - low[d]) / length(d));
    const double inside = x - turns * length(d);
    return inside >= high[d] ? low[d] : inside;  // rounding may land exactly on the upper face
  }
};

}  // namespace stirsph
