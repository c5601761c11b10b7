#include "thermal/free_surface.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "particles/field_names.hpp"
#include "thermal/ring.hpp"

namespace stirsph {
namespace {

// Lengths are in spacings of the particle, volume^(1/dim).
/// Radius of the sphere. Must exceed sqrt(3)/2, where the corners of a lattice cell lie. A larger sphere tolerates more
/// disorder and loses less at edges (exact at about 1.08), a smaller one is nearer to the surface where that is curved.
constexpr double radius = 0.95;
/// Half the width over which the sphere passes from a particle to its neighbour, so that areas change smoothly.
constexpr double ramp = 0.1;
/// Neighbours farther away do not cover any of the sphere.
constexpr double reach = 2 * (radius + ramp);
/// Particles whose kernel sum is less than this factor short of the bulk value are inside: flat faces have 1.3, a
/// disorder of 10 % (20 %) of the spacing gives 1.07 (1.15) at most, rarely.
constexpr double least_correction = 1.06;
/// A rigid surface covers the sphere from here on: half a spacing from the centre, as a flat lattice touches it, also
/// when the particle lies farther back in a notch of a staircase.
constexpr double wall_distance = 0.5;

/// Directions evenly spread over the sphere (circle), with the symmetry of the lattice, and the area of each.
template <int Dim>
struct Directions {
  static constexpr int side = 8;  ///< a cube of 8 x 8 directions per face
  static constexpr int n = Dim == 3 ? 6 * side * side : 64;
  std::array<double, n> x{}, y{}, z{}, area{};

  Directions() {
    if constexpr (Dim == 2) {
      for (int k = 0; k < n; ++k) {
        const double angle = 2 * std::numbers::pi * (k + 0.5) / n;
        set(k, {std::cos(angle), std::sin(angle), 0}, 2 * std::numbers::pi / n * radius);
      }
    } else {
      // Equal angles on the faces of a cube make its cells nearly equal.
      const auto tangent = [](int k) { return std::tan(std::numbers::pi / 4 * ((2 * k + 1.0) / side - 1)); };
      double total = 0;
      for (int k = 0; k < n; ++k) {
        const int face = k / (side * side);
        const double a = tangent(k / side % side), b = tangent(k % side);
        Vec3 direction;
        direction[face / 2] = face % 2 ? 1 : -1;
        direction[(face / 2 + 1) % 3] = a;
        direction[(face / 2 + 2) % 3] = b;
        const double length = norm(direction);
        set(k, direction / length, (1 + a * a) * (1 + b * b) / (length * length * length));
        total += area[k];
      }
      for (double& value : area) value *= 4 * std::numbers::pi * radius * radius / total;
    }
  }

 private:
  void set(int k, const Vec3& direction, double weight) {
    x[k] = direction.x;
    y[k] = direction.y;
    z[k] = direction.z;
    area[k] = weight;
  }
};

/// What sticks out of one particle's sphere.
template <int Dim>
class Exposure {
 public:
  Exposure() : flat_(1) { flat_ = flat_face(); }

  void start() {
    open_.fill(1);
    outward_ = {};
    walls_.clear();
  }

  /// A neighbour covers what is nearer to it than to the particle.
  void add_neighbour(const Vec3& apart) {
    const double square = dot(apart, apart);
    if (square >= reach * reach || square == 0) return;
    const double distance = std::sqrt(square), fade = 1 - square / (reach * reach);
    outward_ -= fade * fade * apart;
    cover(apart / distance, 0.5 * distance);
  }

  void add_wall(const Vec3& normal, double distance) {
    walls_.push_back(normal);
    cover(-normal, std::min(distance, wall_distance));
  }

  /// Area in units of spacing^(Dim - 1), and the outward direction it faces.
  struct Face {
    double area = 0;
    Vec3 direction;
  };
  Face face() const {
    Vec3 sum;
    for (int k = 0; k < Directions<Dim>::n; ++k) {
      const double open = std::max(open_[k], 0.0) * directions_.area[k];
      sum.x += open * directions_.x[k];
      sum.y += open * directions_.y[k];
      if (Dim == 3) sum.z += open * directions_.z[k];
    }
    Vec3 along = outward_;
    for (const Vec3& normal : walls_) along -= std::min(0.0, dot(along, normal)) * normal;
    const double length = norm(along);
    if (!(length > 0)) return {};
    // A surface that faces the wall within 20 to 35 degrees is in contact; what the steps of a lattice leave open there
    // is not.
    const double facing = walls_.empty() ? 1.0 : std::clamp((length / norm(outward_) - 0.3) / 0.3, 0.0, 1.0);
    const Vec3 direction = along / length;
    return {facing * std::max(0.0, dot(sum, direction)) / flat_, direction};
  }

 private:
  /// Covers the directions that lead farther than `distance` along the unit vector `towards`.
  void cover(const Vec3& towards, double distance) {
    const double a = 0.5 + distance / (2 * ramp);
    const Vec3 b = radius / (2 * ramp) * towards;
    for (int k = 0; k < Directions<Dim>::n; ++k) {
      const double along = b.x * directions_.x[k] + b.y * directions_.y[k] + (Dim == 3 ? b.z * directions_.z[k] : 0.0);
      open_[k] = std::min(open_[k], a - along);
    }
  }

  /// The value of a particle on a flat face of a lattice.
  double flat_face() {
    start();
    for (int a = -2; a <= 0; ++a)
      for (int b = -2; b <= 2; ++b)
        for (int c = Dim == 3 ? -2 : 0; c <= (Dim == 3 ? 2 : 0); ++c) add_neighbour({double(a), double(b), double(c)});
    return face().area;
  }

  const Directions<Dim> directions_;
  std::array<double, Directions<Dim>::n> open_;
  Vec3 outward_;
  std::vector<Vec3> walls_;
  double flat_;
};

/// The feet nearer than contact_reach sorted by owned particle.
class FeetOfParticles {
 public:
  FeetOfParticles(std::span<const SurfaceFoot> feet, std::size_t owned) : starts_(owned + 1, 0) {
    for (const SurfaceFoot& foot : feet)
      if (static_cast<std::size_t>(foot.particle) < owned) starts_[foot.particle + 1] += 1;
    for (std::size_t i = 0; i < owned; ++i) starts_[i + 1] += starts_[i];
    sorted_.resize(starts_[owned]);
    std::vector<std::size_t> next(starts_.begin(), starts_.end() - 1);
    for (const SurfaceFoot& foot : feet)
      if (static_cast<std::size_t>(foot.particle) < owned) sorted_[next[foot.particle]++] = &foot;
  }
  std::span<const SurfaceFoot* const> of(std::size_t i) const {
    return {sorted_.data() + starts_[i], sorted_.data() + starts_[i + 1]};
  }

 private:
  std::vector<std::size_t> starts_;
  std::vector<const SurfaceFoot*> sorted_;
};

template <int Dim>
void expose(const ParticleSet& particles, const PairList& pairs, std::span<const SurfaceFoot> feet,
            std::vector<double>& areas) {
  const auto correction = particles[field::conduction_correction];
  const auto volume = particles[field::volume];
  std::array<const double*, Dim> position;
  for (int d = 0; d < Dim; ++d) position[d] = particles.component(field::position, d).data();
  const bool rings = particles.layout().axisymmetric();
  const auto& axes = particles.layout().axes;
  const FeetOfParticles feet_of(feet, particles.owned());
  Exposure<Dim> exposure;
  for (std::size_t i = 0; i < particles.owned(); ++i) {
    if (!(correction[i] > least_correction)) continue;
    const double from_axis = position[0][i];
    const double cell = rings ? volume[i] / circumference(from_axis) : volume[i];
    const double spacing = Dim == 3 ? std::cbrt(cell) : std::sqrt(cell);
    exposure.start();
    for (const std::int32_t j : pairs.candidates(i / cluster_size)) {
      if (rings && is_mirror_image(position[0][j])) continue;
      Vec3 apart;
      for (int d = 0; d < Dim; ++d) apart[d] = (position[d][j] - position[d][i]) / spacing;
      exposure.add_neighbour(apart);
      if (!rings) continue;
      apart.x = -(position[0][j] + from_axis) / spacing;  // what lies on the far side of the axis, the ring itself too
      exposure.add_neighbour(apart);
    }
    for (const SurfaceFoot* foot : feet_of.of(i)) {
      Vec3 normal;
      for (int d = 0; d < Dim; ++d) normal[d] = foot->normal[axes[d]];
      if (foot->distance < contact_reach * spacing) exposure.add_wall(normal, foot->distance / spacing);
    }
    const auto face = exposure.face();
    areas[i] = face.area * (Dim == 3 ? spacing * spacing : spacing);
    // The face lies half a spacing outside the centre: a bore is shorter there, a mantle longer.
    if (rings) areas[i] *= circumference(std::max(0.0, from_axis + 0.5 * spacing * face.direction.x));
  }
}

}  // namespace

std::vector<double> free_surface_areas(const ParticleSet& particles, const PairList& pairs,
                                       std::span<const SurfaceFoot> feet) {
  std::vector<double> areas(particles.owned(), 0.0);
  if (particles.layout().dim == 2)
    expose<2>(particles, pairs, feet, areas);
  else
    expose<3>(particles, pairs, feet, areas);
  return areas;
}

}  // namespace stirsph
