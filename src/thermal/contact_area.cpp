#include "thermal/contact_area.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/error.hpp"
#include "thermal/ring.hpp"

namespace stirsph {
namespace {

// Lengths below are in spacings.
/// Radius of the weight w. Less than 1.5, so that beyond the end of a lattice only its last row is seen and the end is
/// found exactly half a spacing beyond it.
constexpr double radius = contact_neighbourhood / 2;
/// The surface ends where the mean foot is this far aside; half the width over which c falls.
constexpr double edge = 0.5, edge_ramp = 0.2;
/// Quadrature points per spacing. A whole number: on an aligned lattice the points of neighbours then coincide and the
/// partition is exact.
constexpr int points_per_spacing = 3;
constexpr double least_normal_product = 0.5;  // 60 degrees

/// How much a particle at this distance counts against others in front of the same place.
double depth_weight(double distance) {
  const double x = std::clamp(distance / contact_reach, 0.0, 1.0), y = 1 - x * x;
  return y * y;
}

/// How much it counts in the mean that tells where the surface ends. Nearly all or nothing: particles far back in a
/// notch of a staircase must hold against those beside the notch, which are nearer to the surface.
double cover_weight(double distance) { return std::clamp((contact_reach - distance) / 0.1, 0.0, 1.0); }

/// Quadrature points around a foot, in coordinates of its tangent plane.
template <int Dim>
struct Quadrature {
  static constexpr int half = static_cast<int>(radius * points_per_spacing);
  static constexpr double step = 1.0 / points_per_spacing;
  static constexpr double point_area = Dim == 3 ? step * step : step;

  static constexpr bool holds(int a, int b) { return (a * a + b * b) * step * step < radius * radius; }
  static constexpr int count() {
    int n = 0;
    for (int a = -half; a <= half; ++a)
      for (int b = Dim == 3 ? -half : 0; b <= (Dim == 3 ? half : 0); ++b) n += holds(a, b);
    return n;
  }
  static constexpr int n = count();

  std::array<double, n> u{}, v{};
  constexpr Quadrature() {
    int k = 0;
    for (int a = -half; a <= half; ++a)
      for (int b = Dim == 3 ? -half : 0; b <= (Dim == 3 ? half : 0); ++b)
        if (holds(a, b)) {
          u[k] = a * step;
          v[k] = b * step;
          ++k;
        }
  }
};

/// Two unit vectors across the normal; along the axes of coordinates where the normal allows it, because lattices are.
struct TangentFrame {
  Vec3 u, v;
  TangentFrame(const Vec3& normal, const SpaceLayout& layout) {
    if (layout.dim == 2) {
      u[layout.axes[0]] = -normal[layout.axes[1]];
      u[layout.axes[1]] = normal[layout.axes[0]];
      return;
    }
    int least = 0;
    for (int d = 1; d < 3; ++d)
      if (std::abs(normal[d]) < std::abs(normal[least])) least = d;
    Vec3 axis;
    axis[least] = 1;
    u = normalised(axis - normal[least] * normal);
    v = cross(normal, u);
  }
};

/// The feet that count, sorted into cells as wide as their neighbourhood; x runs fastest.
class FootCells {
 public:
  struct Foot {
    std::array<std::int64_t, 3> cell;  // z, y, x
    std::int32_t index;
  };

  FootCells(std::span<const SurfaceFoot> feet, double spacing) {
    const double size = contact_neighbourhood * spacing;
    for (std::size_t k = 0; k < feet.size(); ++k) {
      // The margin keeps every weight above zero in spite of rounding.
      if (!(feet[k].distance < (1 - 1e-12) * contact_reach * spacing)) continue;
      Foot foot{{}, static_cast<std::int32_t>(k)};
      for (int d = 0; d < 3; ++d) foot.cell[2 - d] = static_cast<std::int64_t>(std::floor(feet[k].point[d] / size));
      sorted_.push_back(foot);
    }
    std::sort(sorted_.begin(), sorted_.end(),
              [](const Foot& a, const Foot& b) { return a.cell != b.cell ? a.cell < b.cell : a.index < b.index; });
  }

  /// Calls visit(feet of a cell, indices of the feet in and around it) for every cell that is not empty.
  template <class Visit>
  void visit(Visit&& work) const {
    std::vector<std::int32_t> around;
    for (auto first = sorted_.begin(); first != sorted_.end();) {
      const auto& cell = first->cell;
      const auto last = std::find_if(first, sorted_.end(), [&](const Foot& foot) { return foot.cell != cell; });
      around.clear();
      for (std::int64_t z = cell[0] - 1; z <= cell[0] + 1; ++z)
        for (std::int64_t y = cell[1] - 1; y <= cell[1] + 1; ++y) {
          const std::array<std::int64_t, 3> from{z, y, cell[2] - 1}, to{z, y, cell[2] + 1};
          auto at = std::lower_bound(sorted_.begin(), sorted_.end(), from,
                                     [](const Foot& foot, const auto& key) { return foot.cell < key; });
          for (; at != sorted_.end() && at->cell <= to; ++at) around.push_back(at->index);
        }
      work(std::span<const Foot>(first, last), std::span<const std::int32_t>(around));
      first = last;
    }
  }

 private:
  std::vector<Foot> sorted_;
};

/// The integral at one foot.
template <int Dim>
class FootIntegral {
 public:
  FootIntegral(std::span<const SurfaceFoot> feet, double spacing, const SpaceLayout& layout)
      : feet_(feet), scale_(1 / spacing), layout_(layout) {}

  /// In units of spacing^(Dim - 1). `around` holds the foot itself.
  double operator()(std::int32_t i, std::span<const std::int32_t> around) {
    const SurfaceFoot& foot = feet_[i];
    const TangentFrame frame(foot.normal, layout_);
    sum_.fill(0);
    cover_.fill(0);
    mean_u_.fill(0);
    mean_v_.fill(0);
    for (const std::int32_t j : around) {
      if (j == i) continue;
      const Vec3 apart = scale_ * (feet_[j].point - foot.point);
      const double square = dot(apart, apart);
      if (square >= contact_neighbourhood * contact_neighbourhood ||
          dot(foot.normal, feet_[j].normal) < least_normal_product)
        continue;
      // Curved surfaces are unrolled: the neighbour keeps its direction in the tangent plane and its distance.
      const double u = dot(apart, frame.u), v = Dim == 3 ? dot(apart, frame.v) : 0.0;
      const double flat = std::sqrt(u * u + v * v);
      const double stretch = flat > 0 ? std::sqrt(square) / flat : 1.0;
      add(u * stretch, v * stretch, feet_[j].distance * scale_);
    }
    add(0, 0, foot.distance * scale_);
    return own_share(depth_weight(foot.distance * scale_));
  }

 private:
  using Points = Quadrature<Dim>;
  static constexpr Points points{};

  static double weight(double square) {
    const double x = std::max(0.0, 1 - square / (radius * radius));
    return x * x;
  }

  void add(double u, double v, double distance) {
    const double depth = depth_weight(distance), cover = cover_weight(distance);
    for (int k = 0; k < Points::n; ++k) {
      const double du = u - points.u[k], dv = Dim == 3 ? v - points.v[k] : 0.0;
      double w = weight(du * du + dv * dv);
      sum_[k] += depth * w;
      w *= cover;
      cover_[k] += w;
      mean_u_[k] += w * du;
      if (Dim == 3) mean_v_[k] += w * dv;
    }
  }

  double own_share(double depth) const {
    double area = 0;
    for (int k = 0; k < Points::n; ++k) {
      const double own = depth * weight(points.u[k] * points.u[k] + points.v[k] * points.v[k]);
      const double aside = std::sqrt(mean_u_[k] * mean_u_[k] + mean_v_[k] * mean_v_[k]) / cover_[k];
      const double touched = std::clamp((edge + edge_ramp - aside) / (2 * edge_ramp), 0.0, 1.0);
      area += touched * own / sum_[k];
    }
    return area * Points::point_area;
  }

  std::span<const SurfaceFoot> feet_;
  double scale_;
  SpaceLayout layout_;
  std::array<double, Points::n> sum_, cover_, mean_u_, mean_v_;
};

template <int Dim>
void integrate(std::span<const SurfaceFoot> feet, double spacing, const SpaceLayout& layout,
               std::vector<double>& areas) {
  FootIntegral<Dim> integral(feet, spacing, layout);
  const double unit = Dim == 3 ? spacing * spacing : spacing;
  FootCells(feet, spacing).visit([&](std::span<const FootCells::Foot> cell, std::span<const std::int32_t> around) {
    for (const auto& foot : cell)
      if (static_cast<std::size_t>(foot.index) < areas.size()) areas[foot.index] = unit * integral(foot.index, around);
  });
}

/// The feet, behind them those that the far side of the axis has within `reach` of it, so that a surface that crosses
/// the axis does not end there.
std::vector<SurfaceFoot> with_mirror_images(std::span<const SurfaceFoot> feet, double reach) {
  std::vector<SurfaceFoot> all(feet.begin(), feet.end());
  for (SurfaceFoot foot : feet) {
    if (foot.point.x >= reach) continue;
    foot.point.x = -foot.point.x;
    foot.normal.x = -foot.normal.x;
    all.push_back(foot);
  }
  return all;
}

}  // namespace

std::vector<double> contact_areas(std::span<const SurfaceFoot> feet, std::size_t owned, double spacing,
                                  const SpaceLayout& layout) {
  STIRSPH_EXPECT(owned <= feet.size(), "the feet of owned particles come first");
  std::vector<double> areas(owned, 0.0);
  if (layout.axisymmetric()) {
    integrate<2>(with_mirror_images(feet, contact_neighbourhood * spacing), spacing, layout, areas);
    for (std::size_t f = 0; f < owned; ++f) areas[f] *= circumference(feet[f].point.x);
  } else if (layout.dim == 2) {
    integrate<2>(feet, spacing, layout, areas);
  } else {
    integrate<3>(feet, spacing, layout, areas);
  }
  return areas;
}

}  // namespace stirsph
