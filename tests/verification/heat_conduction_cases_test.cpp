/// E1, E4, E5, E6 and E8 of the verification catalogue: conduction in particles and in meshes, as ordinary scenes.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>

#include "support/heat_scene_run.hpp"

namespace stirsph::testing {
namespace {

constexpr double pi = std::numbers::pi;
constexpr double diffusivity = 188.0 / (2785 * 875);  // of AL
class InBothSpaces : public ::testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Dimensions, InBothSpaces, ::testing::Values(2, 3),
                         [](const auto& space) { return std::to_string(space.param) + "D"; });

/// Overrides for a scene with a slab of particles [low, high] as body 0 and a meshed slab beside it as rigid body 0.
/// The particles' slab is six spacings thick, which is what a periodic direction needs, the mesh two millimetres.
Overrides slab_pair(double low, double high, double spacing, int dim) {
  const Overrides all =
      joined(column(low, high, 3 * spacing, dim), box("rigid.0.shape", {low, 0.1, -1e-3}, {high, 0.102, 1e-3}, dim));
  return joined(all,
                {override_of("numerics.spacing", spacing, "m"), override_of("rigid.0.heat.mesh.near", spacing, "m"),
                 override_of("rigid.0.heat.mesh.far", spacing, "m")});
}

/// E1: rise in a slab |x| < 10 mm, initially 0, its faces at 1 from t = 0.
double heated_slab(double x, double t) {
  double sum = 0;
  for (int n = 0; n < 60; ++n) {
    const double b = (n + 0.5) * pi / 0.01;
    sum += (n % 2 ? -1 : 1) * 2 / (b * 0.01) * std::exp(-b * b * diffusivity * t) * std::cos(b * x);
  }
  return 1 - sum;
}

TEST(HeatedSlab, ExactSolutionOfTheCatalogue) {
  EXPECT_NEAR(heated_slab(0, 0.2), 0.143675, 1e-6);
  EXPECT_NEAR(heated_slab(0, 1.0), 0.810238, 1e-6);
  EXPECT_NEAR(heated_slab(0.005, 0.5), 0.652371, 1e-6);
}

/// Largest errors over the three times of the catalogue.
struct Errors {
  double particles = 0, mesh = 0;
};

Errors heated_slab_errors(double spacing, int dim, const Overrides& more = {}) {
  const auto simulation = started(verification_scene("e1_slab"), joined(slab_pair(-0.01, 0.01, spacing, dim), more));
  Errors worst;
  for (const double t : {0.2, 0.5, 1.0}) {
    run_until(*simulation, t);
    const auto exact = [&](double x) { return 300 + 100 * heated_slab(x, t); };
    worst.particles = std::max(worst.particles, particle_error(*simulation, 300, exact));
    worst.mesh = std::max(worst.mesh, mesh_error(*simulation, 0, 300, exact));
  }
  return worst;
}

TEST_P(InBothSpaces, HeatedSlabE1) {
  const int dim = GetParam();
  const Errors coarse = heated_slab_errors(1e-3, dim), fine = heated_slab_errors(0.5e-3, dim);
  const double particles = order(coarse.particles, fine.particles), mesh = order(coarse.mesh, fine.mesh);
  std::printf("E1, %d-D: L2 error at 10 and 20 spacings: particles %.2e %.2e order %.2f, mesh %.2e %.2e order %.2f\n",
              dim, coarse.particles, fine.particles, particles, coarse.mesh, fine.mesh, mesh);
  EXPECT_LT(fine.particles, 0.01);
  EXPECT_LT(fine.mesh, 0.01);
  EXPECT_GT(particles, 1.7);  // curvature in the two outermost layers, see the README of thermal
  EXPECT_GT(mesh, 1.8);
}

TEST_P(InBothSpaces, HeatedSlabJitteredE1) {
  const double error =
      heated_slab_errors(0.5e-3, GetParam(),
                         {"body.0.jitter=0.1", "rigid.0.heat.mesh.near=2 mm", "rigid.0.heat.mesh.far=2 mm"})
          .particles;
  std::printf("E1, %d-D, 10 %% jitter: L2 error at 20 spacings %.2e\n", GetParam(), error);
  EXPECT_LT(error, 0.01);
}

/// E4: 700 K | 10 mm AL | film 1e4 | 10 mm ST | 300 K, steady.
struct Composite {
  double flux, hot_face, cold_face, imbalance;
};

Composite composite(double spacing, int dim) {
  const double half = 3e-3;
  Overrides all = touching_columns(-0.01, 0.01, half, dim);
  all = joined(
      all, {override_of("numerics.spacing", spacing, "m"), override_of("rigid.0.heat.mesh.near", 1.2 * spacing, "m")});
  const auto simulation = started(verification_scene("e4_composite_slab"), all);
  const double area = dim == 3 ? 36e-6 : 6e-3, step = simulation->scene().time.fixed_step;
  run_until(*simulation, 9 * step);
  const auto heats = [&] {
    return std::array{-history_value(*simulation, "wall.interface_heat"),
                      history_value(*simulation, "steel.interface_heat"),
                      history_value(*simulation, "steel.surface_heat")};
  };
  const auto before = heats();
  run_until(*simulation, 10 * step);
  const auto after = heats();
  double most = -std::numeric_limits<double>::infinity(), least = -most;
  for (int k = 0; k < 3; ++k) {
    most = std::max(most, after[k] - before[k]);
    least = std::min(least, after[k] - before[k]);
  }
  return {least / (area * step), face_temperature(*simulation, 0), mesh_face_temperature(*simulation, 0, 0),
          most / least - 1};
}

TEST_P(InBothSpaces, CompositeSlabE4) {
  const int dim = GetParam();
  const Composite c = composite(1e-3, dim);
  std::printf("E4, %d-D: q %.1f (710444.8), faces %.3f (662.210) %.3f (591.166), flux in over out - 1: %.1e\n", dim,
              c.flux, c.hot_face, c.cold_face, c.imbalance);
  EXPECT_NEAR(c.flux, 710444.8, 1e-3 * 710444.8);
  EXPECT_NEAR(c.hot_face, 662.210, 1e-3 * 400);
  EXPECT_NEAR(c.cold_face, 591.166, 1e-3 * 400);
  EXPECT_LT(std::abs(c.imbalance), 1e-10);
}

/// E5, temperatures at 1/4, 1/2 and 3/4 of the slab.
constexpr std::array kirchhoff{419.917, 532.631, 642.840};

struct Kirchhoff {
  double in, out;          ///< W/m2, fluxes through the walls of the particles
  double particles, mesh;  ///< K, largest errors
};

Kirchhoff kirchhoff_slab(double spacing, int dim) {
  const auto simulation = started(verification_scene("e5_kirchhoff"), slab_pair(0, 0.01, spacing, dim));
  const double step = simulation->scene().time.fixed_step;
  run_until(*simulation, 9 * step);
  const auto heats = [&] {
    return std::array{-history_value(*simulation, "hot_wall.interface_heat"),
                      history_value(*simulation, "cold_wall.interface_heat")};
  };
  const auto before = heats();
  run_until(*simulation, 10 * step);
  const auto after = heats();
  const double area = std::pow(6 * spacing, dim - 1);
  Kirchhoff result{(after[0] - before[0]) / (area * step), (after[1] - before[1]) / (area * step), 0, 0};
  const std::vector<double> mesh = probe_values(*simulation, "T_");
  const std::map<double, double> particles = layers(*simulation);
  for (std::size_t k = 0; k < 3; ++k) {
    const double x = 0.0025 * static_cast<double>(k + 1);
    const auto above = particles.lower_bound(x - 1e-9), below = std::prev(above);
    const double there =
        below->second + (above->second - below->second) * (x - below->first) / (above->first - below->first);
    result.particles = std::max(result.particles, std::abs(there - kirchhoff[k]));
    result.mesh = std::max(result.mesh, std::abs(mesh[k] - kirchhoff[k]));
  }
  return result;
}

TEST_P(InBothSpaces, KirchhoffE5) {
  const int dim = GetParam();
  const Kirchhoff coarse = kirchhoff_slab(1e-3, dim), fine = kirchhoff_slab(0.5e-3, dim);
  std::printf(
      "E5, %d-D: particles: q %.0f (9181181), largest error at 10 and 20 spacings %.3f %.3f K order %.2f; mesh: %.3f "
      "%.3f K order %.2f\n",
      dim, fine.in, coarse.particles, fine.particles, order(coarse.particles, fine.particles), coarse.mesh, fine.mesh,
      order(coarse.mesh, fine.mesh));
  EXPECT_NEAR(fine.in, 9181181, 1e-3 * 9181181);
  EXPECT_NEAR(fine.out, fine.in, 1e-8 * fine.in);  // steady to that after nine steps
  EXPECT_LT(fine.particles, 1e-3 * 450);
  EXPECT_LT(fine.mesh, 1e-3 * 450);
  EXPECT_GT(order(coarse.particles, fine.particles), 1.5);
  EXPECT_GT(order(coarse.mesh, fine.mesh), 1.5);
}

/// E6: the solution.
double manufactured(double x, double t) { return 500 + 150 * std::cos(pi * x / 0.01) * std::exp(-2 * t); }

TEST(Manufactured, SourceOfTheCatalogue) {
  const Scene scene = read_scene(verification_scene("e6_manufactured"));
  const auto& density = scene.heat.sources[0].value;
  EXPECT_NEAR(density({0.25, 0.0, 0.0, 0.0}), 1.365324e9, 1e3);
  EXPECT_NEAR(density({0.25, 0.0025, 0.0, 0.0}), 9.515321e8, 1e3);
  EXPECT_NEAR(density({0.25, 0.005, 0.0, 0.0}), -3.676210e7, 1e3);
}

Errors manufactured_errors(double spacing, double step, int dim, const Overrides& more = {}) {
  const auto simulation =
      started(verification_scene("e6_manufactured"),
              joined(joined(slab_pair(0, 0.01, spacing, dim), {override_of("time.step", step, "s")}), more));
  run_to_end(*simulation);
  const double t = simulation->clock().time;
  const auto exact = [&](double x) { return manufactured(x, t); };
  return {particle_error(*simulation, 500, exact), mesh_error(*simulation, 0, 500, exact)};
}

TEST_P(InBothSpaces, ManufacturedInSpaceE6) {
  const int dim = GetParam();
  const Errors coarse = manufactured_errors(1e-3, 0.02, dim), fine = manufactured_errors(0.5e-3, 0.02, dim);
  const double particles = order(coarse.particles, fine.particles), mesh = order(coarse.mesh, fine.mesh);
  std::printf("E6, %d-D: L2 error at 10 and 20 spacings: particles %.2e %.2e order %.2f, mesh %.2e %.2e order %.2f\n",
              dim, coarse.particles, fine.particles, particles, coarse.mesh, fine.mesh, mesh);
  EXPECT_LT(fine.particles, 0.01);
  EXPECT_LT(fine.mesh, 0.01);
  EXPECT_GT(particles, 1.7);
  EXPECT_GT(mesh, 1.8);
}

/// Temperatures at the end of E6 in all particles and nodes.
struct Fields {
  std::vector<double> particles, mesh;
};

Fields manufactured_fields(int steps, int dim, const Overrides& more) {
  const auto simulation =
      started(verification_scene("e6_manufactured"),
              joined(joined(slab_pair(0, 0.01, 1e-3, dim), more),
                     {override_of("time.step", 0.5 / steps, "s"), "heat.relative_tolerance=1e-12"}));
  run_to_end(*simulation);
  return {gathered(*simulation, field::temperature), simulation->rigid_heat()[0].node_temperature};
}

double largest_difference(const std::vector<double>& a, const std::vector<double>& b) {
  double largest = 0;
  for (std::size_t i = 0; i < a.size(); ++i) largest = std::max(largest, std::abs(a[i] - b[i]));
  return largest;
}

/// Errors in time alone, against many steps on the same particles and mesh.
TEST_P(InBothSpaces, ManufacturedInTimeE6) {
  const int dim = GetParam();
  const Fields reference = manufactured_fields(640, dim, {"heat.scheme=crank_nicolson"});
  const auto orders = [&](const char* name, const Overrides& more) {
    const Fields coarse = manufactured_fields(40, dim, more), fine = manufactured_fields(80, dim, more);
    const double p1 = largest_difference(coarse.particles, reference.particles),
                 p2 = largest_difference(fine.particles, reference.particles),
                 m1 = largest_difference(coarse.mesh, reference.mesh),
                 m2 = largest_difference(fine.mesh, reference.mesh);
    std::printf(
        "E6, %d-D, %s: largest error of 40 and 80 steps: particles %.4f %.4f K order %.2f, mesh %.4f %.4f K order "
        "%.2f\n",
        dim, name, p1, p2, order(p1, p2), m1, m2, order(m1, m2));
    return std::array{order(p1, p2), order(m1, m2)};
  };
  const auto euler = orders("Euler, iterated", {"heat.scheme=backward_euler"});
  const auto once = orders("Crank-Nicolson, properties of the start of the step", {"heat.nonlinear_iterations=1"});
  const auto iterated = orders("Crank-Nicolson, two solves", {"heat.nonlinear_iterations=2"});
  for (int k = 0; k < 2; ++k) {
    EXPECT_GT(euler[k], 0.9);
    EXPECT_GT(once[k], 0.9);
    EXPECT_GT(iterated[k], 1.8);
  }
}

/// E8 in the production scheme, backward Euler: particles and a mesh of the same material that touch.
struct Extremes {
  double particles_low, particles_high, mesh_low, mesh_high, mean;
};

Extremes after_one_step(double step, int dim, const Overrides& more) {
  Overrides all = touching_columns(-0.012, 0.012, 3e-3, dim);
  all = joined(all, {override_of("time.step", step, "s"), override_of("time.end", step, "s")});
  const auto simulation = started(verification_scene("e8_huge_step"), joined(all, more));
  run_to_end(*simulation);
  const std::vector<double> particles = gathered(*simulation, field::temperature);
  const RigidHeat& body = simulation->rigid_heat()[0];
  const auto [particles_low, particles_high] = std::ranges::minmax(particles);
  const auto [mesh_low, mesh_high] = std::ranges::minmax(body.node_temperature);
  return {particles_low, particles_high, mesh_low, mesh_high, 0.5 * (mean(particles) + body.temperature)};
}

TEST_P(InBothSpaces, HugeStepDoesNotOvershootE8) {
  const int dim = GetParam();
  const double decay = diffusivity * std::pow(pi / 0.024, 2);  // of the slowest mode
  const Extremes e = after_one_step(1e3 / decay, dim, {});
  std::printf("E8, %d-D, lambda dt = 1e3: particles %.4f to %.4f K, mesh %.4f to %.4f K, mean %.4f K\n", dim,
              e.particles_low, e.particles_high, e.mesh_low, e.mesh_high, e.mean);
  // The mode began with 100 K, 1/1001 of it is left: the particles stay above the mean, the mesh below; the interface,
  // where they meet, is at the mean within a twentieth of what is left.
  EXPECT_GT(e.particles_low, e.mean - 0.005);
  EXPECT_LT(e.mesh_high, e.mean + 0.005);
  EXPECT_LT(e.particles_high, e.mean + 0.11);
  EXPECT_GT(e.mesh_low, e.mean - 0.11);
}

/// A jump from 600 to 400 K at the interface. Huge steps may not leave that range. Nor may small ones, but for what
/// blunt tetrahedra make of heat that enters at one node: their links may be negative. Refining makes that smaller, not
/// zero.
TEST_P(InBothSpaces, JumpStaysInItsRangeE8) {
  const int dim = GetParam();
  const double decay = diffusivity * std::pow(pi / 0.024, 2);
  for (const double lambda_dt : {1e-3, 1e-1, 1e1, 1e3}) {
    const Extremes e =
        after_one_step(lambda_dt / decay, dim, {"body.0.temperature=600 K", "rigid.0.heat.temperature=400 K"});
    std::printf("E8, %d-D, jump, lambda dt = %g: particles %.4f to %.4f K, mesh %.4f to %.4f K\n", dim, lambda_dt,
                e.particles_low, e.particles_high, e.mesh_low, e.mesh_high);
    const double allowed = lambda_dt < 1 ? 0.005 * 200 : 1e-6;
    EXPECT_LT(std::max(e.particles_high, e.mesh_high), 600 + allowed);
    EXPECT_GT(std::min(e.particles_low, e.mesh_low), 400 - allowed);
  }
}

}  // namespace
}  // namespace stirsph::testing
