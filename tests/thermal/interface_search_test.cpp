/// The interfaces of particles and meshed bodies: feet, weights, areas, pressures, friction heat that must not be lost,
/// and the hybrid coupling.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "support/rigid_bodies.hpp"
#include "thermal/interface_search.hpp"

namespace stirsph {
namespace {

using namespace testing;  // NOLINT: the helpers of this family of tests
using Role = RigidHeat::Role;

TEST(InterfacePoints, FilmGrowsWithPressure) {
  RigidHeat heat;
  heat.interface_conductance = 100;
  EXPECT_EQ(heat.film(5e6), 100);
  heat.pressure_conductance = 2000;
  heat.reference_pressure = 10e6;
  heat.pressure_exponent = 0.95;
  EXPECT_EQ(heat.film(0), 100);
  EXPECT_NEAR(heat.film(10e6), 2100, 1e-9);
  EXPECT_NEAR(heat.film(40e6), 100 + 2000 * std::pow(4.0, 0.95), 1e-9);
}

// ---- where particles meet a mesh -----------------------------------------------------------------------------------

/// A domain without periodic directions.
Domain endless(int dim) {
  Domain domain;
  domain.dim = dim;
  return domain;
}

/// A plate under the block, moved and turned: feet, weights and areas in the frame of the body.
struct MovedPlate {
  MovedPlate() {
    pose.centre = {1 * mm, 2 * mm, 0};
    pose.axis = {0, 0, 1};
    pose.angle = 0.4;
    pose.translation = {0.3 * mm, -0.2 * mm, 0};
    rigids.push_back(
        {"plate", std::make_shared<Box>(Vec3{-9 * mm, -9 * mm, -2 * mm}, Vec3{12 * mm, 12 * mm, 0}), pose});
    heat.push_back(meshed(box_mesh({-9 * mm, -9 * mm, -2 * mm}, {12 * mm, 12 * mm, 0}, 1.7 * mm), steel(), {}));
  }
  InterfaceSearch search(const Lattice& lattice, bool hybrid) const {
    return {{{0, {true}, hybrid, 0}},
            rigids,
            heat,
            endless(3),
            layout_of<Cartesian3>(),
            CubicSpline{},
            lattice.spacing,
            lattice.h_over_dx * lattice.spacing};
  }
  RigidPose pose;
  std::vector<RigidBody> rigids;
  std::vector<RigidHeat> heat;
};

void add_search_fields(ParticleSet& particles) {
  HeatSolver::add_fields(particles);
  particles.add(field::rigid_heat, 1);
  particles.add(field::rigid_impulse, 1);
}

TEST(InterfacePoints, LieOnTheMeshOfAMovedBodyAndTakeTheFrictionHeat) {
  Lattice lattice = block();
  lattice.jitter = 0;
  LatticeBody body(Comm(), lattice, add_search_fields);
  const MovedPlate plate;
  for (const bool hybrid : {false, true}) {
    InterfaceSearch search = plate.search(lattice, hybrid);
    search.check_fit(body.particles, plate.rigids, plate.heat);
    double heat = 0, impulse = 0;
    for (std::size_t i = 0; i < body.particles.owned(); ++i) {
      // Also of particles far from the plate, which have left it since.
      heat += body.particles.component(field::rigid_heat, 0)[i] =
          1e-3 * (1 + std::fmod(body.particles[field::id][i], 7));
      impulse += body.particles.component(field::rigid_impulse, 0)[i] = 2e-4;
    }
    const auto points = search.take_points(body.particles, plate.rigids, plate.heat, 0.5);
    double taken = 0, area = 0;
    for (const InterfacePoint& point : points) {
      taken += point.heat;
      area += point.area;
      const Vec3 x = body.particles.vector_at(field::position, point.particle);
      Vec3 place;
      double weights = 0;
      for (const NodeWeight& node : point.nodes) {
        place += node.weight * plate.heat[0].mesh->mesh().nodes[node.node];
        weights += node.weight;
        EXPECT_GE(node.weight, -1e-12);
      }
      EXPECT_NEAR(weights, 1, 1e-12);
      const Vec3 foot{x.x, x.y, 0};
      if (point.shape_factor > 0) {
        EXPECT_EQ(point.area, 0);
        EXPECT_EQ(point.heat, 0);
        EXPECT_LT(place.z, 0) << "embedded particles are inside";
        // The nearer of them count most, and lie around the particle.
        EXPECT_LT(std::hypot((plate.pose.to_scene(place) - foot).x, (plate.pose.to_scene(place) - foot).y),
                  0.2 * lattice.spacing);
      } else {
        EXPECT_LT(norm(plate.pose.to_scene(place) - foot), 1e-12);
        EXPECT_NEAR(point.distance, x.z, 1e-15);
        if (point.area > 0) {
          EXPECT_NEAR(point.pressure, 2e-4 / (0.5 * point.area), 1e-9 * point.pressure);
        }
      }
    }
    EXPECT_NEAR(Comm().sum(taken), Comm().sum(heat), 1e-12 * Comm().sum(heat));
    const double face = lattice.count[0] * lattice.count[1] * lattice.spacing * lattice.spacing;
    EXPECT_NEAR(Comm().sum(area) / face, hybrid ? 0 : 1, 0.01);
    for (std::size_t i = 0; i < body.particles.owned(); ++i) {
      EXPECT_EQ(body.particles.component(field::rigid_heat, 0)[i], 0);
      EXPECT_EQ(body.particles.component(field::rigid_impulse, 0)[i], 0);
    }
  }
}

TEST(InterfacePoints, OnlyOfTheChosenBodies) {
  Lattice lattice = block();
  LatticeBody body(Comm(), lattice, add_search_fields);
  for (std::size_t i = 0; i < body.particles.total(); ++i)
    body.particles[field::body][i] = body.particles.vector_at(field::position, i).x < 3 * mm ? 0 : 1;
  const MovedPlate plate;
  for (const bool hybrid : {false, true}) {
    InterfaceSearch search({{0, {true, false}, hybrid, 0}}, plate.rigids, plate.heat, endless(3),
                           layout_of<Cartesian3>(), CubicSpline{}, lattice.spacing,
                           lattice.h_over_dx * lattice.spacing);
    std::int64_t count = 0;
    for (const InterfacePoint& point : search.take_points(body.particles, plate.rigids, plate.heat, 1)) {
      EXPECT_EQ(body.particles[field::body][point.particle], 0);
      ++count;
    }
    EXPECT_GT(Comm().sum(count), 40);
  }
}

// ---- hybrid interface ----------------------------------------------------------------------------------------------

TEST(Interfaces, KeepAUniformTemperatureToTheLastBit) {
  const Lattice lattice = block();
  for (const bool hybrid : {true, false}) {
    LatticeBody body(Comm(), lattice, add_search_fields);
    for (double& t : body.particles[field::temperature]) t = 456.789;
    MovedPlate plate;
    plate.heat[0].start_at(456.789);
    plate.heat[0].interface_conductance = 1e4;
    InterfaceSearch search = plate.search(lattice, hybrid);
    HeatSolver solver(Comm(), CubicSpline{}, 3, settings_for(lattice), {alloy()});
    for (int step = 0; step < 2; ++step) {
      const auto points = search.take_points(body.particles, plate.rigids, plate.heat, 0.1);
      EXPECT_GT(Comm().sum(static_cast<std::int64_t>(points.size())), 90);
      solver.advance(body.particles, body.pairs, body.halo, points, plate.heat, 0.1);
    }
    for (std::size_t i = 0; i < body.particles.owned(); ++i) EXPECT_EQ(body.particles[field::temperature][i], 456.789);
    for (const double t : plate.heat[0].node_temperature) EXPECT_EQ(t, 456.789);
  }
}

/// Particles from x = -L to 0, a mesh from 0 to L, one as hot as the other is cold at its far end; the flux through
/// both against that of perfect contact.
double flux_ratio(int count, const ThermalProperties& particles, const ThermalProperties& solid) {
  constexpr double length = 10 * mm;
  Lattice lattice;
  lattice.dim = 2;
  lattice.count = {count, count, 1};
  lattice.spacing = length / count;
  lattice.density = 2785;
  LatticeBody body(Comm(), lattice, add_search_fields);
  for (double& t : body.particles[field::temperature]) t = 500;
  const auto shape = std::make_shared<Box>(Vec3{length, 0, -infinite}, Vec3{2 * length, length, infinite});
  SimplexMesh mesh = box_mesh({length, 0, -infinite}, {2 * length, length, infinite}, lattice.spacing, 2);
  const auto far = facets_at(mesh, 0, 2 * length);
  std::vector<RigidHeat> heat{meshed(std::move(mesh), solid, {fixed_at(far, 300)}, 500)};
  heat.emplace_back();
  heat[1].role = Role::FixedTemperature;
  heat[1].temperature = 700;
  heat[1].interface_conductance = infinite;
  const std::vector<RigidBody> rigids{{"solid", shape, {}}, {"hot", shape, {}}};
  InterfaceSearch search({{0, {true}, true, 0}}, rigids, heat, endless(2), layout_of<PlaneStrain>(), CubicSpline{},
                         lattice.spacing, lattice.h_over_dx * lattice.spacing);
  HeatSolver solver(Comm(), CubicSpline{}, 2, settings_for(lattice), {particles});
  const double dt = 1e5;
  HeatReport report;
  for (int step = 0; step < 3; ++step) {
    auto points = search.take_points(body.particles, rigids, heat, dt);
    for (std::size_t i = 0; i < body.particles.owned(); ++i)
      if (const double x = body.particles.component(field::position, 0)[i]; x < lattice.spacing)
        points.push_back({static_cast<std::int32_t>(i), 1, x, lattice.spacing});
    report = solver.advance(body.particles, body.pairs, body.halo, points, heat, dt);
  }
  // Embedded particles are neighbours: next to them nothing is missing.
  for (std::size_t i = 0; i < body.particles.owned(); ++i) {
    const Vec3 x = body.particles.vector_at(field::position, i);
    if (x.x > 0.5 * length && std::abs(x.y - 0.5 * length) < 0.2 * length) {
      EXPECT_NEAR(body.particles[field::conduction_correction][i], 1, 1e-9);
    }
  }
  const double flow = report.bodies[0].surface / dt;  // W/m
  EXPECT_NEAR(report.bodies[0].interface / dt / flow, 1, 1e-6) << "steady";
  EXPECT_NEAR(report.bodies[1].interface / dt / flow, -1, 1e-6) << "steady";
  const double perfect = 400 * length / (length / particles.conductivity(0) + length / solid.conductivity(0));
  return flow / perfect;
}

/// What a particle of the first layer lacks of the kernel sum of the bulk it finds in the body: A1, bulk less face.
TEST(HybridInterface, EmbeddedParticlesFillTheLatticeA1) {
  const double dx = 0.5 * mm;
  const auto shape = std::make_shared<Box>(Vec3{-4 * mm, -4 * mm, -3 * mm}, Vec3{4 * mm, 4 * mm, 0});
  const RigidHeat heat = meshed(box_mesh({-4 * mm, -4 * mm, -3 * mm}, {4 * mm, 4 * mm, 0}, 1 * mm), steel(), {});
  HybridInterface hybrid(*heat.mesh, *shape, CubicSpline{}, layout_of<Cartesian3>(), dx, 1.3 * dx);
  const InterfacePoint point = hybrid.point_at({0.5 * dx, 0.5 * dx, 0.5 * dx}, dx * dx * dx, 1.3 * dx);
  EXPECT_NEAR(point.kernel_sum, (1 - 2.738172e-3) - 0.767847, 1e-6);
  EXPECT_FALSE(hybrid.point_at({0.5 * dx, 0.5 * dx, 3.2 * dx}, dx * dx * dx, 1.3 * dx).shape_factor > 0);
}

TEST(HybridInterface, SteadyFluxIsThatOfPerfectContact) {
  for (const auto& [what, particles, solid] : {std::tuple{"equal conductivities", aluminium(), aluminium()},
                                               std::tuple{"aluminium on steel", aluminium(), steel()},
                                               std::tuple{"steel on aluminium", steel(), aluminium()}}) {
    double errors[3];
    const int counts[] = {10, 20, 40};
    for (int k = 0; k < 3; ++k) errors[k] = flux_ratio(counts[k], particles, solid) - 1;
    if (Comm().is_root())
      std::printf("hybrid interface, %s: flux off by %+.4f, %+.4f, %+.4f at 10, 20, 40 spacings\n", what, errors[0],
                  errors[1], errors[2]);
    EXPECT_LT(std::abs(errors[0]), 0.03) << what;
    EXPECT_LT(std::abs(errors[2]), 0.4 * std::abs(errors[0])) << what << ": first order, edges as long as spacings";
  }
}

}  // namespace
}  // namespace stirsph
