/// E7 of the verification catalogue: heat sources that move through particles and meshes or over their surfaces.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <numbers>

#include "support/heat_scene_run.hpp"

namespace stirsph::testing {
namespace {

constexpr double pi = std::numbers::pi;
constexpr double heat_capacity = 2785.0 * 875, diffusivity = 188 / heat_capacity;  // of AL
class InBothSpaces : public ::testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Dimensions, InBothSpaces, ::testing::Values(2, 3),
                         [](const auto& space) { return std::to_string(space.param) + "D"; });

double normal_distribution(double x) { return 0.5 * std::erfc(-x / std::numbers::sqrt2); }

/// Quasi-steady rise at the distance x ahead of a plane source of 1e6 W/m2 and 0.05 m/s that is spread over a Gaussian
/// of the width s: the plane source's profile, 1 behind and exp(-x v/alpha) ahead, averaged with that Gaussian.
double plane_source(double x, double s) {
  const double speed = 0.05, plateau = 1e6 / (heat_capacity * speed), rate = speed / diffusivity;
  return plateau * (normal_distribution(-x / s) +
                    std::exp(-rate * x + 0.5 * rate * rate * s * s) * normal_distribution(x / s - rate * s));
}

TEST(PlaneSource, ExactSolutionOfTheCatalogue) {
  EXPECT_NEAR(plane_source(-1, 1e-3), 8.20723, 1e-5);
  EXPECT_NEAR(1e-3 / std::log(plane_source(8e-3, 1e-5) / plane_source(9e-3, 1e-5)), 1.54296e-3, 1e-8);
}

struct PlaneErrors {
  double particles = 0, mesh = 0, plateau = 0, lead_length = 0;
};

PlaneErrors plane_errors(double spacing, int dim) {
  const Overrides all =
      joined(column(0, 0.075, 3 * spacing, dim), box("rigid.0.shape", {0, 0.1, -1e-3}, {0.075, 0.102, 1e-3}, dim));
  const auto simulation = started(
      verification_scene("e7_plane_source"),
      joined(all, {override_of("numerics.spacing", spacing, "m"), override_of("rigid.0.heat.mesh.near", spacing, "m"),
                   override_of("rigid.0.heat.mesh.far", spacing, "m")}));
  run_to_end(*simulation);
  const double source = 0.01 + 0.05 * simulation->clock().time;
  PlaneErrors errors;
  const std::map<double, double> particles = layers(*simulation);
  for (const auto& [x, temperature] : particles)
    if (x > source - 8e-3)
      errors.particles = std::max(errors.particles, std::abs(temperature - 300 - plane_source(x - source, 1e-3)));
  const RigidHeat& mesh = simulation->rigid_heat()[0];
  for (std::size_t n = 0; n < mesh.mesh->nodes(); ++n) {
    const double ahead = mesh.mesh->mesh().nodes[n].x - source;
    if (ahead > -8e-3)
      errors.mesh = std::max(errors.mesh, std::abs(mesh.node_temperature[n] - 300 - plane_source(ahead, 1e-3)));
  }
  const auto behind = particles.lower_bound(source - 7e-3), near = particles.lower_bound(source + 4e-3),
             far = particles.lower_bound(source + 7e-3);
  errors.plateau = behind->second - 300;
  errors.lead_length = (far->first - near->first) / std::log((near->second - 300) / (far->second - 300));
  return errors;
}

TEST_P(InBothSpaces, PlaneSourceE7) {
  const int dim = GetParam();
  const PlaneErrors coarse = plane_errors(1e-3, dim), fine = plane_errors(0.5e-3, dim);
  const double peak = 8.20723;
  std::printf(
      "E7, %d-D, plane source: plateau %.4f K (8.2072), lead length %.4f mm (1.5430); largest error of particles %.2f "
      "%% then %.2f %% of the plateau, order %.2f; mesh %.2f %% %.2f %%, order %.2f\n",
      dim, fine.plateau, 1e3 * fine.lead_length, 100 * coarse.particles / peak, 100 * fine.particles / peak,
      order(coarse.particles, fine.particles), 100 * coarse.mesh / peak, 100 * fine.mesh / peak,
      order(coarse.mesh, fine.mesh));
  EXPECT_LT(fine.particles, 0.02 * peak);
  EXPECT_LT(fine.mesh, 0.02 * peak);
  EXPECT_NEAR(fine.plateau, peak, 0.02 * peak);
  EXPECT_NEAR(fine.lead_length, 1.54296e-3, 0.02 * 1.54296e-3);
  EXPECT_GT(order(coarse.particles, fine.particles), 1.5);
  EXPECT_GT(order(coarse.mesh, fine.mesh), 1.5);
}

/// Rise in a half space (dim = 3) or half plane (dim = 2) after the time t at `ahead` of a Gaussian source of the width
/// s = 3 mm that moves at 0.02 m/s over its surface, and `depth` below it. Power 500 W or 50 kW/m. The integral over
/// the age of the heat, in the square root of the age.
double moving_spot(double ahead, double depth, double t, int dim) {
  const double s2 = 9e-6, speed = 0.02, power = dim == 3 ? 500 : 5e4;
  const int parts = 4000;
  double sum = 0;
  for (int i = 0; i < parts; ++i) {
    const double root = std::sqrt(t) * (i + 0.5) / parts, age = root * root;
    const double width = s2 + 2 * diffusivity * age;
    const double along = std::exp(-0.5 * std::pow(ahead + speed * age, 2) / width);
    sum += 2 * along / std::pow(2 * pi * width, 0.5 * (dim - 1)) / std::sqrt(pi * diffusivity) *
           std::exp(-depth * depth / (4 * diffusivity * age));
  }
  return power / heat_capacity * sum * std::sqrt(t) / parts;
}

struct Place {
  double ahead, depth;
};
const std::vector<Place> spot_places{{0, 0}, {-3e-3, 0}, {-10e-3, 0}, {0, 3e-3}, {5e-3, 0}};  // those of the catalogue

TEST(MovingSpot, ExactSolutionOfTheCatalogue) {
  const double table[] = {135.214, 117.948, 38.023, 52.859, 45.416};
  for (std::size_t k = 0; k < spot_places.size(); ++k)
    EXPECT_NEAR(moving_spot(spot_places[k].ahead, spot_places[k].depth, 1, 3), table[k], 1e-3);
}

/// Temperature of the particles of an undistorted lattice at a place: linear along the surface, and into the depth the
/// parabola through three layers. Collective.
class LatticeField {
 public:
  explicit LatticeField(const Simulation& simulation)
      : dim_(simulation.particles().layout().dim), spacing_(simulation.scene().numerics.spacing) {
    const std::vector<double> temperature = gathered(simulation, field::temperature);
    std::array<std::vector<double>, 3> x;
    for (int d = 0; d < dim_; ++d) x[d] = gathered(simulation, field::position, d);
    for (std::size_t i = 0; i < temperature.size(); ++i) {
      std::array<long, 3> cell{};
      for (int d = 0; d < dim_; ++d) cell[d] = std::lround(x[d][i] / spacing_ - 0.5);
      values_[cell] = temperature[i];
    }
  }

  /// The surface is the plane of coordinate 0 across the last direction; y = 0 in three dimensions.
  double operator()(double x, double depth) const {
    const double layer = depth / spacing_ - 0.5;
    const long first = std::max(0L, std::lround(layer) - 1);
    double value = 0;
    for (int i = 0; i < 3; ++i) {
      double weight = 1;
      for (int j = 0; j < 3; ++j)
        if (j != i) weight *= (layer - static_cast<double>(first + j)) / (i - j);
      value += weight * in_layer(x, -1 - first - i);
    }
    return value;
  }

 private:
  double in_layer(double x, long layer) const {
    const double place = x / spacing_ - 0.5;
    const long left = static_cast<long>(std::floor(place));
    // The parabola through four sites, so that the interpolation adds less than the method's own error.
    double value = 0;
    for (int i = -1; i <= 2; ++i) {
      double weight = 1;
      for (int j = -1; j <= 2; ++j)
        if (j != i) weight *= (place - static_cast<double>(left + j)) / (i - j);
      const long site = left + i;
      value += weight * (dim_ == 3 ? across(site, layer) : values_.at({site, layer, 0}));
    }
    return value;
  }
  /// On the line y = 0, which lies between the sites -1 and 0: the cubic through the four nearest.
  double across(long site, long layer) const {
    return (9 * (values_.at({site, -1, layer}) + values_.at({site, 0, layer})) - values_.at({site, -2, layer}) -
            values_.at({site, 1, layer})) /
           16;
  }

  int dim_;
  double spacing_;
  std::map<std::array<long, 3>, double> values_;
};

/// Largest error over the places of the catalogue [K].
double spot_error(const char* name, int dim, const std::function<double(std::size_t)>& temperature) {
  double largest = 0;
  std::printf("E7, %d-D, moving spot, %s (exact):", dim, name);
  for (std::size_t k = 0; k < spot_places.size(); ++k) {
    const double exact = moving_spot(spot_places[k].ahead, spot_places[k].depth, 1, dim);
    const double rise = temperature(k) - 300;
    std::printf("  %.2f (%.2f)", rise, exact);
    largest = std::max(largest, std::abs(rise - exact));
  }
  const double relative = largest / moving_spot(0, 0, 1, dim);
  std::printf(" K, largest error %.2f %% of the peak\n", 100 * relative);
  return relative;
}

double spot_error_in_particles(const Simulation& simulation) {
  const LatticeField field(simulation);
  return spot_error("particles", simulation.particles().layout().dim,
                    [&](std::size_t k) { return field(spot_places[k].ahead, spot_places[k].depth); });
}

double spot_error_in_mesh(const Simulation& simulation) {
  const std::vector<double> probes = probe_values(simulation, "T_");
  return spot_error("mesh", simulation.particles().layout().dim, [&](std::size_t k) { return probes[k]; });
}

TEST(MovingSpot, ParticlesE7) {
  const auto simulation = started(verification_scene("e7_moving_spot"));
  run_to_end(*simulation);
  EXPECT_LT(spot_error_in_particles(*simulation), 0.02);
}

TEST(MovingSpot, MeshE7) {
  std::array<double, 2> errors{};
  for (int k = 0; k < 2; ++k) {
    const double factor = k == 0 ? 2 : 1;  // edges and their growth
    const auto simulation =
        started(verification_scene("e7_moving_spot_mesh"), {override_of("rigid.0.heat.mesh.near", 0.4e-3 * factor, "m"),
                                                            override_of("rigid.0.heat.mesh.growth", 0.1 * factor, "")});
    run_to_end(*simulation);
    errors[k] = spot_error_in_mesh(*simulation);
  }
  std::printf("E7, 3-D, moving spot: order of the mesh %.2f\n", order(errors[0], errors[1]));
  EXPECT_LT(errors[1], 0.02);
  EXPECT_GT(order(errors[0], errors[1]), 1);
}

TEST(MovingLine, ParticlesAndMeshE7) {
  std::array<double, 2> particles{}, mesh{};
  for (int k = 0; k < 2; ++k) {
    const double spacing = 2e-3 / (k + 1);
    const auto simulation =
        started(verification_scene("e7_moving_line_2d"),
                {override_of("numerics.spacing", spacing, "m"), override_of("rigid.0.heat.mesh.near", spacing, "m"),
                 override_of("rigid.0.heat.mesh.far", spacing, "m")});
    run_to_end(*simulation);
    particles[k] = spot_error_in_particles(*simulation);
    mesh[k] = spot_error_in_mesh(*simulation);
  }
  std::printf("E7, 2-D, moving line: order of particles %.2f, of the mesh %.2f\n", order(particles[0], particles[1]),
              order(mesh[0], mesh[1]));
  EXPECT_LT(particles[1], 0.02);
  EXPECT_LT(mesh[1], 0.02);
  EXPECT_GT(order(particles[0], particles[1]), 1);
  EXPECT_GT(order(mesh[0], mesh[1]), 1);
}

}  // namespace
}  // namespace stirsph::testing
