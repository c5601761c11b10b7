#include "geometry/lattice.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "base/error.hpp"

namespace stirsph {
namespace {

/// The lattice cells that can hold points of a shape.
class CandidateCells {
 public:
  CandidateCells(const ShapeFunction& shape, double spacing, const LatticeOptions& options)
      : shape_(shape),
        spacing_(spacing),
        origin_(options.origin),
        // A point exactly on the margin is taken: rounding must not decide.
        deepest_(-options.margin.value_or(0.25 * spacing) + 1e-9 * spacing),
        dimensions_(options.dimensions),
        axes_(options.axes),
        half_plane_(options.half_plane),
        above_(options.above) {
    const Bounds bounds = shape.bounds();
    double candidates = 1;
    for (int i = 0; i < dimensions_; ++i) {
      const int axis = axes_[i];
      if (!std::isfinite(bounds.low[axis]) || !std::isfinite(bounds.high[axis]))
        throw InputError(
            fmt::format("a shape that is filled with particles must be bounded, but this one has no end along "
                        "{}: {}. Give it a height, or cut it with a box",
                        "xyz"[axis], shape.describe()));
      const double low = std::floor((bounds.low[axis] - origin_[axis]) / spacing) - 1;
      const double high = std::ceil((bounds.high[axis] - origin_[axis]) / spacing) + 1;
      candidates *= std::max(0.0, high - low);
      // 1e12 candidates would take hours to count; beyond it is a slip of units rather than a large run.
      if (candidates > 1e12)
        throw InputError(fmt::format("a spacing of {} m gives more than 1e12 lattice cells in {}. Check the units",
                                     spacing, shape.describe()));
      low_[i] = static_cast<std::int64_t>(low);
      high_[i] = static_cast<std::int64_t>(high);
    }
  }

  std::int64_t first_layer() const { return low_[last()]; }
  std::int64_t end_layer() const { return high_[last()]; }

  /// Calls work(point) for every point of one layer across the last direction, in their order.
  template <class Work>
  void visit_layer(std::int64_t layer, Work work) const {
    std::array<std::int64_t, 3> cell{};
    cell[last()] = layer;
    const bool solid = dimensions_ == 3;
    for (std::int64_t j = solid ? low_[1] : 0; j < (solid ? high_[1] : 1); ++j) {
      if (solid) cell[1] = j;
      for (cell[0] = low_[0]; cell[0] < high_[0]; ++cell[0]) {
        Vec3 point = origin_;
        if (half_plane_) point.y = 0;
        for (int i = 0; i < dimensions_; ++i) point[axes_[i]] += (static_cast<double>(cell[i]) + 0.5) * spacing_;
        if (half_plane_ && point.x <= 0) continue;
        if (below_a_plane(point)) continue;
        if (shape_.distance(point) <= deepest_) work(point);
      }
    }
  }

 private:
  int last() const { return dimensions_ - 1; }
  bool below_a_plane(const Vec3& point) const {
    for (int d = 0; d < 3; ++d)
      if (above_[d] && point[d] <= *above_[d]) return true;
    return false;
  }

  const ShapeFunction& shape_;
  double spacing_;
  Vec3 origin_;
  double deepest_;
  int dimensions_;
  std::array<int, 3> axes_;
  bool half_plane_;
  std::array<std::optional<double>, 3> above_;
  std::array<std::int64_t, 3> low_{}, high_{};  ///< candidate cells, the upper end excluded
};

}  // namespace

LatticeSlice fill_with_lattice(const ShapeFunction& shape, double spacing, const LatticeOptions& options, int rank,
                               int size) {
  if (!(spacing > 0)) throw InputError(fmt::format("particle spacing = {} m: must be > 0 m", spacing));
  if (options.dimensions != 2 && options.dimensions != 3)
    throw Error(ExitCode::Internal, "a lattice has 2 or 3 dimensions");
  const CandidateCells cells(shape, spacing, options);
  std::vector<std::int64_t> before;  // number of points below each layer
  LatticeSlice slice;
  for (std::int64_t layer = cells.first_layer(); layer < cells.end_layer(); ++layer) {
    before.push_back(slice.total);
    cells.visit_layer(layer, [&](const Vec3&) { ++slice.total; });
  }
  before.push_back(slice.total);
  if (slice.total == 0)
    throw InputError(
        fmt::format("no lattice point of spacing {} m lies in {}. Take a smaller spacing or check the units", spacing,
                    shape.describe()));
  slice.first = slice.total * rank / size;
  const std::int64_t end = slice.total * (rank + 1) / size;
  slice.points.reserve(end - slice.first);
  for (std::size_t i = 0; i + 1 < before.size(); ++i) {
    if (before[i + 1] <= slice.first || before[i] >= end) continue;
    std::int64_t index = before[i];
    cells.visit_layer(cells.first_layer() + static_cast<std::int64_t>(i), [&](const Vec3& point) {
      if (index >= slice.first && index < end) slice.points.push_back(point);
      ++index;
    });
  }
  return slice;
}

}  // namespace stirsph
