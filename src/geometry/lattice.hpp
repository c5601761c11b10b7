/// Fills a shape with particles on a square or cubic lattice.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "geometry/shape.hpp"

namespace stirsph {

struct LatticeOptions {
  int dimensions = 3;
  std::array<int, 3> axes{0, 1, 2};  ///< directions of the lattice; in two dimensions the third coordinate is origin's
  bool half_plane = false;           ///< only points with y = 0, x > 0, whatever the y of the origin
  std::array<std::optional<double>, 3> above{};  ///< m, of x, y, z: only points beyond these planes
  Vec3 origin{};                                 ///< a corner of a lattice cell [m]
  std::optional<double>
      margin{};  ///< a point is taken at least this far inside [m]; a quarter of the spacing by default
};

/// A contiguous piece of the lattice points of a shape.
struct LatticeSlice {
  std::vector<Vec3> points;  ///< m
  std::int64_t first = 0;    ///< global index of points.front()
  std::int64_t total = 0;    ///< number of points on all ranks
};

/// The points origin + (half-integers) * spacing inside the shape, numbered with the first direction running fastest,
/// then the second, then the third. Rank `rank` of `size` gets the points total*rank/size to total*(rank+1)/size:
/// number and place of each point do not depend on the number of ranks. Not collective: every rank counts all points
/// itself. Throws InputError when the shape is unbounded or holds no point.
LatticeSlice fill_with_lattice(const ShapeFunction& shape, double spacing, const LatticeOptions& options = {},
                               int rank = 0, int size = 1);

}  // namespace stirsph
