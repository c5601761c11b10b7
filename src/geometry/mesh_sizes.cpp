#include "geometry/mesh_sizes.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include <fmt/format.h>

#include "base/error.hpp"

namespace stirsph {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

/// About how many elements the sizes ask for within a cell [m]: its volume over that of regular elements. Cells are
/// halved where the size changes much within one.
double expected_elements(const ShapeFunction& shape, const ShapeMeshOptions& options, const Bounds& cell,
                         int depth = 0) {
  const int dim = options.dimensions;
  const auto axes = mesh_axes(options);
  const Vec3 middle = 0.5 * (cell.low + cell.high);
  const double radius = 0.5 * norm(cell.high - cell.low), size = edge_length_at(options.sizes, middle);
  const double outside = shape.distance(middle);
  if (outside > radius) return 0;
  if (depth < 3 || (depth < 6 && options.sizes.growth * radius > 0.5 * size)) {
    double sum = 0;
    for (int corner = 0; corner < (dim == 3 ? 8 : 4); ++corner) {
      Bounds part = cell;
      for (int i = 0; i < dim; ++i) (corner >> i & 1 ? part.low : part.high)[axes[i]] = middle[axes[i]];
      sum += expected_elements(shape, options, part, depth + 1);
    }
    return sum;
  }
  double elements = outside < 0 ? (dim == 3 ? 6 * std::numbers::sqrt2 : 4 / std::numbers::sqrt3) : 0;
  for (int i = 0; i < dim; ++i) elements *= (cell.high[axes[i]] - cell.low[axes[i]]) / size;
  return elements;
}

}  // namespace

void check_mesh_options(const ShapeMeshOptions& options) {
  const MeshSizes& sizes = options.sizes;
  if (options.dimensions != 2 && options.dimensions != 3) throw InputError("a mesh has 2 or 3 dimensions");
  if (!(sizes.near > 0) || !(sizes.far >= sizes.near) || !std::isfinite(sizes.far))
    throw InputError(
        fmt::format("mesh sizes must satisfy 0 < near <= far; given: near {} m, far {} m", sizes.near, sizes.far));
  if (!(sizes.growth > 0)) throw InputError("the growth of mesh sizes must be > 0");
}

double edge_length_at(const MeshSizes& sizes, const Vec3& point) {
  if (sizes.refine_at.empty()) return sizes.near;
  double distance = infinity;
  for (const auto& shape : sizes.refine_at) distance = std::min(distance, shape->distance(point));
  return std::min(sizes.far, sizes.near + sizes.growth * std::max(distance, 0.0));
}

Bounds meshed_region(const ShapeFunction& shape, const ShapeMeshOptions& options) {
  Bounds region = shape.bounds();
  const auto axes = mesh_axes(options);
  if (options.axisymmetric) region.low.x = 0;
  for (int k = 0; k < options.dimensions; ++k) {
    const int i = axes[k];
    if (options.cut) {
      region.low[i] = std::max(region.low[i], options.cut->low[i]);
      region.high[i] = std::min(region.high[i], options.cut->high[i]);
    }
    if (!std::isfinite(region.low[i]) || !std::isfinite(region.high[i]))
      throw InputError(fmt::format("{}: endless along {}: give a bounding box to cut it with before it is meshed",
                                   shape.describe(), "xyz"[i]));
    if (region.low[i] >= region.high[i])
      throw InputError(fmt::format("{}: nothing of it lies within the bounding box", shape.describe()));
  }
  if (options.dimensions == 2) region.low[axes[2]] = region.high[axes[2]] = 0;
  return region;
}

void check_element_count(const ShapeFunction& shape, const ShapeMeshOptions& options) {
  constexpr double most = 2e7;
  const double count = expected_elements(shape, options, meshed_region(shape, options));
  if (count > most)
    throw InputError(
        fmt::format("{}: edges of {:.4g} to {:.4g} mm would make about {:.1e} elements. Allowed: {:.0e}. "
                    "Enlarge near, far or growth",
                    shape.describe(), 1e3 * options.sizes.near, 1e3 * options.sizes.far, count, most));
}

}  // namespace stirsph
