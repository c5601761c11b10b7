/// The search for heat interfaces: pressures from impulses, friction heat that must not be lost, areas, meshes.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "geometry/mesh_shape.hpp"
#include "geometry/primitives.hpp"
#include "support/lattice.hpp"
#include "thermal/interface_search.hpp"

namespace stirsph {
namespace {

using testing::Lattice;
using testing::LatticeBody;

/// A block of 8 x 6 x 5 particles standing on the plane z = 0, which is a rigid body.
struct BlockOnPlane {
  BlockOnPlane()
      : body(Comm(), lattice(), [](ParticleSet& particles) {
          particles.add(field::rigid_heat, 1);
          particles.add(field::rigid_impulse, 1);
        }) {
    rigids.push_back({"plane", std::make_shared<HalfSpace>(Vec3{}, Vec3{0, 0, 1}), {}});
    heat.resize(1);
    heat[0].role = RigidHeat::Role::FixedTemperature;
    heat[0].interface_conductance = 100;
  }
  static Lattice lattice() {
    Lattice result;
    result.count = {8, 6, 5};
    result.spacing = 1e-3;
    return result;
  }
  std::vector<InterfacePoint> take(double elapsed) {
    InterfaceSearch search({{0, {true}, false, 0}}, rigids, heat, body.domain, CubicSpline{}, 1e-3, 1.3e-3);
    return search.take_points(body.particles, rigids, heat, elapsed);
  }
  LatticeBody body;
  std::vector<RigidBody> rigids;
  std::vector<RigidHeat> heat;
};

TEST(Interface, PressureIsImpulseOverTimeAndArea) {
  BlockOnPlane block;
  ParticleSet& particles = block.body.particles;
  for (std::size_t i = 0; i < particles.owned(); ++i) particles.component(field::rigid_impulse, 0)[i] = 6e-3;  // N s
  const auto points = block.take(2e-3);
  double area = 0;
  for (const InterfacePoint& point : points) {
    EXPECT_NEAR(point.distance, 0.5e-3, 1e-12);
    EXPECT_NEAR(point.pressure, 6e-3 / 2e-3 / point.area, 1e-6 * point.pressure);
    area += point.area;
  }
  EXPECT_NEAR(Comm().sum(area), 48e-6, 0.02 * 48e-6);  // edges: within the 1 to 2 % of surface_area_test
  for (std::size_t i = 0; i < particles.owned(); ++i)
    EXPECT_EQ(particles.component(field::rigid_impulse, 0)[i], 0) << "taken: the next interval starts at zero";
}

TEST(Interface, FilmGrowsWithPressure) {
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

/// Heat of particles that have left the surface, or never are at it, reaches the body all the same.
TEST(Interface, FrictionHeatIsNotLost) {
  BlockOnPlane block;
  ParticleSet& particles = block.body.particles;
  double put = 0;
  for (std::size_t i = 0; i < particles.owned(); ++i)
    put += particles.component(field::rigid_heat, 0)[i] = 1e-3 * (1 + particles[field::id][i]);
  double taken = 0, without_area = 0;
  for (const InterfacePoint& point : block.take(1e-3)) {
    taken += point.heat;
    if (point.area == 0) without_area += point.heat;
  }
  EXPECT_NEAR(taken, put, 1e-12 * put);
  EXPECT_GT(Comm().sum(without_area), 0.5 * Comm().sum(put));  // four of five layers do not touch
  for (const InterfacePoint& point : block.take(1e-3)) EXPECT_EQ(point.heat, 0) << "taken once";
}

/// A meshed, turned and displaced body: weights of a point reproduce its place in the body's frame.
TEST(Interface, WeightsFindThePlaceOnAMovingMesh) {
  BlockOnPlane block;
  const auto disc = make_cylinder({0, 0, -0.004}, {0, 0, 1}, 0.02, 0.004);
  ShapeMeshOptions options;
  options.sizes.near = options.sizes.far = 0.003;
  const ThermalProperties steel{{{24.4}}, {{460}}};
  block.heat[0].role = RigidHeat::Role::Mesh;
  block.heat[0].mesh = std::make_shared<const HeatMesh>(mesh_shape(disc, options).mesh, steel, 7800);
  block.heat[0].start_at(300);
  block.rigids[0].shape = disc;
  block.rigids[0].pose.angle = 0.7;
  block.rigids[0].pose.translation = {1e-3, -2e-3, 0};
  const auto points = block.take(1e-3);
  double area = 0;
  for (const InterfacePoint& point : points) {
    area += point.area;
    Vec3 place;
    double sum = 0;
    for (const NodeWeight& node : point.nodes) {
      place += node.weight * block.heat[0].mesh->mesh().nodes[node.node];
      sum += node.weight;
    }
    EXPECT_NEAR(sum, 1, 1e-12);
    const Vec3 x = block.body.particles.vector_at(field::position, point.particle);
    const Vec3 foot = block.rigids[0].pose.to_body({x.x, x.y, 0});
    EXPECT_LT(norm(place - foot), 0.8e-3);  // within the particle's own footprint, half its diagonal
  }
  EXPECT_NEAR(Comm().sum(area), 48e-6, 0.02 * 48e-6);
}

}  // namespace
}  // namespace stirsph
