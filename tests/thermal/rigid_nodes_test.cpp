/// Heat in meshed rigid bodies: exact fields and fluxes, films and sources by hand, every joule of a system of bodies
/// of all roles, the points at which particles exchange heat, and the same answer on any ranks (E2, E4, E5, E9 of the
/// catalogue for tetrahedra and triangles).
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <functional>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "support/rigid_bodies.hpp"
#include "thermal/interface_search.hpp"
#include "thermal/rigid_nodes.hpp"

namespace stirsph {
namespace {

using namespace testing;  // NOLINT: the helpers of this family of tests
using Role = RigidHeat::Role;
using Scheme = HeatSettings::Scheme;

Lattice no_particles(int dim = 3) {
  Lattice lattice;
  lattice.dim = dim;
  lattice.count = {4, 4, 4};
  lattice.spacing = 1 * mm;
  lattice.inside = [](const Vec3&) { return false; };
  return lattice;
}

/// Bodies alone, without a particle.
class BodiesAlone {
 public:
  explicit BodiesAlone(int dim = 3, HeatSettings settings = settings_for(no_particles()))
      : body_(Comm(), no_particles(dim), HeatSolver::add_fields),
        solver_(Comm(), CubicSpline{}, dim, settings, {aluminium()}) {}

  HeatReport advance(std::vector<RigidHeat>& bodies, double dt) {
    return solver_.advance(body_.particles, body_.pairs, body_.halo, {}, bodies, dt);
  }

 private:
  LatticeBody body_;
  HeatSolver solver_;
};

double sum_of(const std::vector<double>& values) {
  double sum = 0;
  for (const double value : values) sum += value;
  return sum;
}

constexpr double length = 10 * mm, width = 6 * mm, height = 4 * mm;

/// A rod with its end x = 0 at 300 K whose other end is held, heated or cooled, turned by an angle so that no element
/// is aligned with the heat flow. Six steps of 1000 times the slowest mode's time and more are
/// steady to the last digits.
struct Rod {
  Rod(int dimensions, const std::function<std::vector<SurfaceCondition>(const std::vector<std::int32_t>&)>& other_end)
      : dim(dimensions), area(dim == 3 ? width * height : width) {
    SimplexMesh mesh =
        box_mesh({0, 0, dim == 3 ? 0 : -infinite}, {length, width, dim == 3 ? height : infinite}, 1.5 * mm, dim);
    end = facets_at(mesh, 0, length);
    std::vector<SurfaceCondition> conditions{fixed_at(facets_at(mesh, 0, 0), 300)};
    for (const SurfaceCondition& condition : other_end(end)) conditions.push_back(condition);
    for (const Vec3& node : mesh.nodes) along.push_back(node.x);
    const Vec3 axis = dim == 3 ? normalised(Vec3{1, 2, 3}) : Vec3{0, 0, 1};
    for (Vec3& node : mesh.nodes) node = rotated(node, axis, 0.7);
    bodies.push_back(meshed(std::move(mesh), steel(), conditions));
  }
  HeatReport steady(double flux = 0) {
    HeatReport report;
    BodiesAlone alone(dim);
    for (int step = 0; step < 6; ++step) {
      bodies[0].node_input = bodies[0].mesh->lumped_area(end);
      for (double& input : bodies[0].node_input) input *= flux * dt;
      report = alone.advance(bodies, dt);
    }
    return report;
  }
  void expect_linear(double slope) const {  // K/m
    for (std::size_t n = 0; n < along.size(); ++n)
      ASSERT_NEAR(bodies[0].node_temperature[n], 300 + slope * along[n], 1e-9) << "node " << n;
  }
  static constexpr double dt = 1e4;
  int dim;
  double area;
  std::vector<std::int32_t> end;
  std::vector<double> along;
  std::vector<RigidHeat> bodies;
};

TEST(MeshConduction, IsExactForLinearFields) {
  for (const int dim : {2, 3}) {
    Rod held(dim, [](const auto& end) { return std::vector{fixed_at(end, 400)}; });
    EXPECT_NEAR(held.steady().fixed_heat, 0, 1e-8 * steel_k * 1e4 * held.area * Rod::dt) << "what comes in goes out";
    held.expect_linear(100 / length);

    Rod heated(dim, [](const auto&) { return std::vector<SurfaceCondition>{}; });
    const double flux = 2.44e5;  // W/m2
    const HeatReport in = heated.steady(flux);
    heated.expect_linear(flux / steel_k);
    EXPECT_NEAR(in.fixed_heat / (flux * heated.area * Rod::dt), 1, 1e-9);
    EXPECT_NEAR(in.source_heat / (flux * heated.area * Rod::dt), 1, 1e-12);

    Rod cooled(dim, [](const auto& end) { return std::vector{film_at(end, 5e3, 400)}; });
    const HeatReport through = cooled.steady();
    const double exact = 100 / (1 / 5e3 + length / steel_k);  // W/m2
    cooled.expect_linear(exact / steel_k);
    EXPECT_NEAR(through.ambient_heat / (-exact * cooled.area * Rod::dt), 1, 1e-9);
    EXPECT_NEAR(through.fixed_heat / (exact * cooled.area * Rod::dt), 1, 1e-9);
    EXPECT_NEAR(through.bodies[0].surface, 0, 1e-9 * through.fixed_heat);
  }
}

/// E5 on tetrahedra: the flux of Kirchhoff's integral heats the far end to 750 K.
TEST(MeshConduction, KirchhoffE5) {
  Rod rod(3, [](const auto&) { return std::vector<SurfaceCondition>{}; });
  SimplexMesh mesh = rod.bodies[0].mesh->mesh();
  std::vector<std::int32_t> cold;
  for (std::size_t f = 0; f < mesh.surface.size(); ++f) {
    const auto& nodes = mesh.surface[f];
    if (rod.along[nodes[0]] + rod.along[nodes[1]] + rod.along[nodes[2]] < 1e-9)
      cold.push_back(static_cast<std::int32_t>(f));
  }
  std::vector<RigidHeat> bodies{meshed(mesh, alloy(), {fixed_at(cold, 300)}, 500)};
  HeatSettings settings = settings_for(no_particles());
  settings.nonlinear_iterations = 30;
  BodiesAlone alone(3, settings);
  for (int step = 0; step < 6; ++step) {
    bodies[0].node_input = bodies[0].mesh->lumped_area(rod.end);
    for (double& input : bodies[0].node_input) input *= 9181181.0 * 20;
    alone.advance(bodies, 20);
  }
  for (std::size_t n = 0; n < rod.along.size(); ++n)
    if (rod.along[n] > length - 1e-9) {
      EXPECT_NEAR(bodies[0].node_temperature[n], 750, 0.75);  // 1e-3, the bound of the catalogue, at 7 elements
    }
}

TEST(MeshLumping, VolumesMassesAndAreasAreShareOuts) {
  for (const int dim : {2, 3}) {
    SimplexMesh mesh =
        box_mesh({0, 0, dim == 3 ? 0 : -infinite}, {length, width, dim == 3 ? height : infinite}, 1.5 * mm, dim);
    const auto end = facets_at(mesh, 0, length);
    const HeatMesh heat(mesh, steel(), steel_density);
    double volume = 0, mass = 0;
    for (std::size_t n = 0; n < heat.nodes(); ++n) {
      EXPECT_GT(heat.node_volume(n), 0);
      volume += heat.node_volume(n);
      mass += heat.node_mass(n);
    }
    const double exact = length * width * (dim == 3 ? height : 1);
    EXPECT_NEAR(volume / exact, 1, 1e-12);
    EXPECT_NEAR(mass / (steel_density * exact), 1, 1e-12);
    const std::vector<double> area = heat.lumped_area(end);
    EXPECT_NEAR(sum_of(area) / (width * (dim == 3 ? height : 1)), 1, 1e-12);
    for (std::size_t n = 0; n < heat.nodes(); ++n) EXPECT_EQ(area[n] > 0, mesh.nodes[n].x > length - 1e-9);
  }
}

TEST(MeshConduction, KeepsTheEnthalpyWithPropertiesOfTemperature) {
  for (const Scheme scheme : {Scheme::BackwardEuler, Scheme::CrankNicolson})
    for (const int iterations : {1, 8}) {
      std::vector<RigidHeat> bodies{meshed(box_mesh({0, 0, 0}, {length, width, height}, 1.5 * mm), alloy(), {})};
      randomise_nodes(bodies[0]);
      HeatSettings settings = settings_for(no_particles(), 1e-6);
      settings.scheme = scheme;
      settings.nonlinear_iterations = iterations;
      BodiesAlone alone(3, settings);
      const double before = enthalpy(bodies[0]);
      double moved = 0;
      for (int step = 0; step < 4; ++step) {
        const std::vector<double> start = bodies[0].node_temperature;
        const HeatReport report = alone.advance(bodies, 0.005);
        EXPECT_NEAR(report.rigid_heat, 0, 1e-12 * before);
        for (std::size_t n = 0; n < start.size(); ++n)
          moved += std::abs(bodies[0].node_temperature[n] - start[n]) / static_cast<double>(start.size());
      }
      EXPECT_GT(moved, 50) << "K: the heat did spread";
      EXPECT_NEAR(enthalpy(bodies[0]), before, 1e-12 * before);
      double sum = 0, capacity = 0;
      for (std::size_t n = 0; n < bodies[0].mesh->nodes(); ++n) {
        const double t = bodies[0].node_temperature[n], c = bodies[0].mesh->node_mass(n) * alloy().specific_heat(t);
        sum += c * t;
        capacity += c;
      }
      EXPECT_NEAR(bodies[0].temperature, sum / capacity, 1e-9) << "mean weighted with the heat capacity";
    }
}

/// With a huge conductivity the mesh has one temperature, and a film all around gives, in backward Euler,
/// (T - Ta)' = (T - Ta)/(1 + h A dt/C).
TEST(MeshSurface, FilmByHand) {
  SimplexMesh mesh = box_mesh({0, 0, 0}, {length, width, height}, 2 * mm);
  std::vector<std::int32_t> all(mesh.surface.size());
  for (std::size_t f = 0; f < all.size(); ++f) all[f] = static_cast<std::int32_t>(f);
  std::vector<RigidHeat> bodies{meshed(mesh, {{{1e8}}, {{460}}}, {film_at(all, 150, 293.15)}, 693.15)};
  BodiesAlone alone;
  const double area = 2 * (length * width + length * height + width * height);
  const double capacity = 460 * steel_density * length * width * height;
  double expected = 400;
  for (int step = 0; step < 4; ++step) {
    const HeatReport report = alone.advance(bodies, 30);
    const double lost = expected - expected / (1 + 150 * area * 30 / capacity);
    expected -= lost;
    EXPECT_NEAR(report.ambient_heat / (capacity * lost), 1, 1e-6);
    EXPECT_NEAR(report.bodies[0].surface / (capacity * lost), 1, 1e-6);
    EXPECT_NEAR(report.bodies[0].gained / (-capacity * lost), 1, 1e-6);
    EXPECT_NEAR(bodies[0].temperature - 293.15, expected, 1e-4);
  }
}

TEST(MeshSources, AreCountedToTheLastJoule) {
  SimplexMesh mesh = box_mesh({0, 0, 0}, {length, width, height}, 1.5 * mm);
  const auto cold = facets_at(mesh, 0, 0);
  std::vector<RigidHeat> bodies{meshed(mesh, steel(), {fixed_at(cold, 300)}), meshed(mesh, steel(), {})};
  BodiesAlone alone;
  // A density into all nodes, fixed ones included, and a flux through a face that shares nodes with the fixed one.
  const double density = 1e9, flux = 1e6, dt = 0.1;
  for (RigidHeat& body : bodies) {
    body.node_input = body.mesh->lumped_area(facets_at(mesh, 1, 0));
    for (std::size_t n = 0; n < body.mesh->nodes(); ++n)
      body.node_input[n] = dt * (flux * body.node_input[n] + density * body.mesh->node_volume(n));
  }
  const double exact = dt * (density * length * width * height + flux * length * height);
  const HeatReport report = alone.advance(bodies, dt);
  EXPECT_NEAR(report.source_heat / (2 * exact), 1, 1e-12);
  EXPECT_NEAR((report.bodies[0].gained + report.bodies[0].surface) / exact, 1, 1e-11);
  EXPECT_NEAR(report.bodies[1].gained / exact, 1, 1e-11);
  EXPECT_GT(report.bodies[0].surface, 0.01 * exact);
  for (const RigidHeat& body : bodies)
    for (const double input : body.node_input) EXPECT_EQ(input, 0) << "used once";
}

TEST(MeshSurface, ConditionsThatContradictAreRefused) {
  SimplexMesh mesh = box_mesh({0, 0, 0}, {length, width, height}, 2 * mm);
  const auto one = facets_at(mesh, 0, 0), other = facets_at(mesh, 1, 0);
  try {
    HeatMesh(mesh, steel(), steel_density, {fixed_at(one, 300), fixed_at(other, 400)});
    FAIL() << "the nodes of the common edge have two temperatures";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("300 K and 400 K"), std::string::npos) << error.what();
  }
  EXPECT_THROW(HeatMesh(mesh, steel(), steel_density, {fixed_at({}, 300)}), InputError);
  const HeatMesh same(mesh, steel(), steel_density, {fixed_at(one, 300), fixed_at(other, 300)});
  EXPECT_TRUE(same.fixed(mesh.surface[one[0]][0]));
}

/// E9: with links of particles on its surface, free and fixed nodes, the matrix of the nodes is symmetric and positive.
TEST(HeatMatrixE9, OfTheNodesIsSymmetricAndPositive) {
  SimplexMesh mesh = box_mesh({0, 0, 0}, {length, width, height}, 2 * mm);
  const auto end = facets_at(mesh, 0, length);
  const std::vector<RigidHeat> bodies{meshed(std::move(mesh), steel(), {fixed_at(end, 300)})};
  const Comm alone(MPI_COMM_SELF);
  RigidNodes nodes(alone, bodies);
  constexpr std::size_t particles = 3;
  nodes.number_rows(alone, particles);
  nodes.begin_step(bodies);
  nodes.linearise(bodies, 1);
  std::vector<NodeWeight> weights;
  std::vector<RigidLink> links;
  weights.reserve(3 * particles);
  for (std::size_t p = 0; p < particles; ++p) {
    const std::size_t first = weights.size();
    const auto& facet = bodies[0].mesh->mesh().surface[7 * p];
    for (int c = 0; c < 3; ++c) weights.push_back({facet[c], c == 0 ? 0.5 : 0.25});
    links.push_back({static_cast<std::int32_t>(p), 0, 0.3, 0, {weights.data() + first, 3}});
  }
  nodes.receive_links(alone, links, std::vector<double>{0, 1, 2}, std::vector<double>(particles, 400));
  HeatMatrix matrix;
  HeatMatrixWriter writer(matrix, 0, particles + nodes.owned(), true);
  for (std::size_t p = 0; p < particles; ++p) {  // the particles' rows, as the solver writes them
    writer.begin_row();
    writer.add_global(static_cast<std::int64_t>(p), 1 + 0.3);
    for (const NodeWeight& node : links[p].nodes)
      if (!nodes.fixed(node.node)) writer.add_global(nodes.row(node.node), -0.3 * node.weight);
    writer.end_row();
  }
  std::vector<double> right(nodes.owned());
  nodes.fill(writer, right, 1.0, 1.0);
  const auto times = [&](const std::vector<double>& x) {
    std::vector<double> y(x.size(), 0.0);
    for (std::size_t r = 0; r < matrix.rows(); ++r)
      for (int k = matrix.own.starts[r]; k < matrix.own.starts[r + 1]; ++k)
        y[r] += matrix.own.values[k] * x[matrix.own.columns[k]];
    return y;
  };
  const auto product = [](const std::vector<double>& a, const std::vector<double>& b) {
    double sum = 0;
    for (std::size_t k = 0; k < a.size(); ++k) sum += a[k] * b[k];
    return sum;
  };
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> between(-1, 1);
  std::vector<double> x(matrix.rows()), y(matrix.rows());
  for (int trial = 0; trial < 20; ++trial) {
    for (double& value : x) value = between(random);
    for (double& value : y) value = between(random);
    const double scale = std::sqrt(product(times(x), times(x)) * product(y, y));
    EXPECT_NEAR(product(y, times(x)), product(x, times(y)), 1e-14 * scale);
    EXPECT_GT(product(x, times(x)), 0);
  }
  // Heat that leaves one row arrives at another: without capacities and fixed nodes the rows sum to zero.
  const std::vector<double> ones(matrix.rows(), 1.0), sums = times(ones);
  for (std::size_t p = 0; p < particles; ++p) {
    double to_fixed = 0;
    for (const NodeWeight& node : links[p].nodes) to_fixed += nodes.fixed(node.node) ? 0.3 * node.weight : 0;
    EXPECT_NEAR(sums[p], 1 + to_fixed, 1e-14);
  }
}

// ---- particles between bodies of all roles ------------------------------------------------------------------------

void randomise(LatticeBody& body) {
  for (std::size_t i = 0; i < body.particles.owned(); ++i) {
    std::mt19937_64 random(7919 * static_cast<std::uint64_t>(body.particles[field::id][i]) + 1);
    body.particles[field::temperature][i] = std::uniform_real_distribution<double>(300, 750)(random);
    body.particles[field::heat_input][i] = std::uniform_real_distribution<double>(0, 1e-3)(random);
  }
}

/// Around the block: 0 a mesh below (bottom and a part of the touched face at 320 K), 1 a lumped body at x = 0, 2 a
/// fixed one at the other end, 3 a meshed one above with properties of temperature and surroundings, one medium with
/// the particles, 4 an insulated one beside it.
struct Surrounded {
  explicit Surrounded(const Lattice& lattice) {
    end = lattice.count[0] * lattice.spacing;
    top = lattice.count[2] * lattice.spacing;
    SimplexMesh below = box_mesh({-1 * mm, -1 * mm, -3 * mm}, {end + 1 * mm, 5 * mm, 0}, 1 * mm);
    std::vector<std::int32_t> touched;
    for (const auto f : facets_at(below, 2, 0))
      if (facet_centroid(below, f).x < 2 * mm) touched.push_back(f);
    bodies.push_back(meshed(below, alloy(), {fixed_at(facets_at(below, 2, -3 * mm), 320), fixed_at(touched, 320)}));
    bodies[0].interface_conductance = 2e4;
    randomise_nodes(bodies[0], 3);
    bodies.resize(5);
    bodies[1].role = Role::LumpedNode;
    bodies[1].temperature = 600;
    bodies[1].heat_capacity = 0.05;
    bodies[1].ambient_conductance = 0.8;
    bodies[1].interface_conductance = 1e4;
    bodies[2].role = Role::FixedTemperature;
    bodies[2].temperature = 400;
    bodies[2].interface_conductance = infinite;
    above = std::make_shared<Box>(Vec3{0, 0, top}, Vec3{end, 4 * mm, top + 2 * mm});
    SimplexMesh mesh = box_mesh({0, 0, top}, {end, 4 * mm, top + 2 * mm}, 0.8 * mm);
    const auto roof = facets_at(mesh, 2, top + 2 * mm);
    bodies[3] = meshed(std::move(mesh), alloy(), {film_at(roof, 400, 293.15)});
    bodies[3].interface_conductance = infinite;
    randomise_nodes(bodies[3], 5);
    hybrid = std::make_unique<HybridInterface>(*bodies[3].mesh, *above, CubicSpline{}, layout_of<Cartesian3>(),
                                               lattice.spacing, lattice.h_over_dx * lattice.spacing);
  }

  /// With friction heat, which a body of its own kind gets known on the rank that made it only.
  std::vector<InterfacePoint> points(const LatticeBody& body, const Lattice& lattice) {
    std::vector<InterfacePoint> result;
    const auto volume = body.particles[field::volume], h = body.particles[field::smoothing_length];
    for (std::size_t i = 0; i < body.particles.owned(); ++i) {
      const Vec3 x = body.particles.vector_at(field::position, i);
      const double distances[] = {x.z, x.x, end - x.x};
      for (int b = 0; b < 3; ++b) {
        if (distances[b] >= 0.85 * lattice.spacing) continue;
        InterfacePoint point;
        point.particle = static_cast<std::int32_t>(i);
        point.body = b;
        point.distance = distances[b];
        point.area = lattice.spacing * lattice.spacing;
        point.heat = 1e-4 * (b + 1);
        if (b == 0) point.nodes = nodes_around(*bodies[0].mesh, {x.x, x.y, 0});
        result.push_back(point);
      }
      InterfacePoint path = hybrid->point_at(x, volume[i], h[i]);
      if (!(path.shape_factor > 0)) continue;
      path.particle = static_cast<std::int32_t>(i);
      path.body = 3;
      path.heat = 5e-5;
      result.push_back(path);
    }
    return result;
  }

  /// Sources in the meshed bodies, alike on all ranks; returns their sum [J].
  double add_sources() {
    double sum = 0;
    for (const int b : {0, 3}) {
      bodies[b].node_input.assign(bodies[b].mesh->nodes(), 0);
      for (std::size_t n = 0; n < bodies[b].mesh->nodes(); ++n)
        sum += bodies[b].node_input[n] = 3e6 * bodies[b].mesh->node_volume(n);
    }
    return sum;
  }

  double end, top;
  ShapePointer above;
  std::vector<RigidHeat> bodies;
  std::unique_ptr<HybridInterface> hybrid;
};

double particle_enthalpy(const LatticeBody& body) {
  double sum = 0;
  for (std::size_t i = 0; i < body.particles.owned(); ++i)
    sum += body.particles[field::mass][i] * alloy().specific_heat.integral(300, body.particles[field::temperature][i]);
  return Comm().sum(sum);
}

TEST(BodiesOfAllRoles, EveryJouleIsFoundAgain) {
  for (const Scheme scheme : {Scheme::BackwardEuler, Scheme::CrankNicolson})
    for (const int iterations : {1, 5}) {
      const Lattice lattice = block();
      LatticeBody body(Comm(), lattice, HeatSolver::add_fields);
      randomise(body);
      Surrounded around(lattice);
      std::vector<RigidHeat>& bodies = around.bodies;
      HeatSettings settings = settings_for(lattice, 1e-6);
      settings.scheme = scheme;
      settings.nonlinear_iterations = iterations;
      HeatSolver solver(Comm(), CubicSpline{}, 3, settings, {alloy()});
      ParticleFilm film;
      film.conductance.assign(body.particles.owned(), 1e-5);
      for (int step = 0; step < 3; ++step) {
        const auto points = around.points(body, lattice);
        std::vector<double> friction(5, 0.0);
        for (const InterfacePoint& point : points) friction[point.body] += point.heat;
        Comm().sum_in_place(friction);
        double own = 0;
        for (std::size_t i = 0; i < body.particles.owned(); ++i) own += body.particles[field::heat_input][i];
        own = Comm().sum(own);
        const double in_meshes = around.add_sources(), given = sum_of(friction) + own + in_meshes;
        const double inputs[] = {sum_of(bodies[0].node_input), 0, 0, sum_of(bodies[3].node_input), 0};
        const double particles_before = particle_enthalpy(body), below = enthalpy(bodies[0]),
                     above = enthalpy(bodies[3]), lumped = bodies[1].temperature;
        const HeatReport r =
            solver.advance(body.particles, body.pairs, body.halo, points, bodies, 0.02, step == 2 ? &film : nullptr);
        const double scale = std::abs(r.particle_heat) + std::abs(r.rigid_heat) + std::abs(r.fixed_heat) +
                             std::abs(r.ambient_heat) + r.source_heat;
        const double tolerance = 1e-11 * scale;  // rounding: the balance does not rest on the solver's tolerance
        EXPECT_NEAR(r.particle_heat + r.rigid_heat + r.fixed_heat + r.ambient_heat, r.source_heat, tolerance);
        EXPECT_NEAR(r.source_heat, given, 1e-12 * scale);
        // The report is what happened to the temperatures.
        EXPECT_NEAR(particle_enthalpy(body) - particles_before, r.particle_heat, tolerance);
        EXPECT_NEAR(enthalpy(bodies[0]) - below, r.bodies[0].gained, tolerance);
        EXPECT_NEAR(enthalpy(bodies[3]) - above, r.bodies[3].gained, tolerance);
        EXPECT_NEAR(0.05 * (bodies[1].temperature - lumped), r.bodies[1].gained, tolerance);
        EXPECT_EQ(bodies[2].temperature, 400);
        // And closes body by body; what particles give is what bodies get.
        double interface = 0, gained = 0;
        for (int b = 0; b < 5; ++b) {
          const BodyHeat& heat = r.bodies[b];
          EXPECT_NEAR(heat.gained + heat.surface, heat.interface + heat.friction + inputs[b], tolerance)
              << "body " << b;
          EXPECT_NEAR(heat.friction, friction[b], 1e-12 * scale);
          interface += heat.interface;
          gained += heat.gained;
        }
        EXPECT_NEAR(gained, r.rigid_heat, tolerance);
        EXPECT_EQ(r.bodies[4].interface, 0);
        EXPECT_GT(std::abs(r.bodies[0].interface), 1e-3 * scale);
        EXPECT_GT(std::abs(r.bodies[3].interface), 1e-3 * scale);
        EXPECT_GT(r.bodies[0].surface, 1e-3 * scale);
        if (step < 2) {
          EXPECT_NEAR(r.particle_heat + interface, own, tolerance);
        }
        for (std::size_t n = 0; n < bodies[0].mesh->nodes(); ++n)
          if (bodies[0].mesh->fixed(n)) {
            EXPECT_EQ(bodies[0].node_temperature[n], 320);
          }
      }
      std::vector<double> agreed;
      for (const RigidHeat& heat : bodies)
        for (const double t : heat.node_temperature) agreed.insert(agreed.end(), {t, -t});
      std::vector<double> largest = agreed;
      Comm().max_in_place(largest);
      EXPECT_EQ(largest, agreed) << "node temperatures are the same on all ranks";
    }
}

/// Every rank also solves the whole problem alone, and compares its particles and all nodes.
void expect_ranks_agree(const Lattice& lattice, const std::function<std::vector<RigidHeat>()>& make_bodies,
                        const std::function<std::vector<InterfacePoint>(const LatticeBody&, const Lattice&)>& points) {
  HeatSettings settings = settings_for(lattice, 1e-13);
  const auto solve_on = [&](const Comm& comm, LatticeBody& body, std::vector<RigidHeat>& bodies) {
    randomise(body);
    HeatSolver solver(comm, CubicSpline{}, 3, settings, {alloy()});
    for (int step = 0; step < 3; ++step)
      solver.advance(body.particles, body.pairs, body.halo, points(body, lattice), bodies, 0.02);
  };
  const Comm alone(MPI_COMM_SELF), all;
  LatticeBody whole(alone, lattice, HeatSolver::add_fields), part(all, lattice, HeatSolver::add_fields);
  auto bodies_of_whole = make_bodies(), bodies_of_part = make_bodies();
  solve_on(alone, whole, bodies_of_whole);
  solve_on(all, part, bodies_of_part);
  std::vector<double> expected(static_cast<std::size_t>(lattice.count[0] * lattice.count[1] * lattice.count[2]));
  for (std::size_t i = 0; i < whole.particles.owned(); ++i)
    expected[static_cast<std::size_t>(whole.particles[field::id][i])] = whole.particles[field::temperature][i];
  const double tolerance = 1e-12 * 750;  // K
  for (std::size_t i = 0; i < part.particles.owned(); ++i)
    EXPECT_NEAR(part.particles[field::temperature][i], expected[static_cast<std::size_t>(part.particles[field::id][i])],
                tolerance);
  for (std::size_t b = 0; b < bodies_of_whole.size(); ++b) {
    EXPECT_NEAR(bodies_of_part[b].temperature, bodies_of_whole[b].temperature, tolerance);
    for (std::size_t n = 0; n < bodies_of_whole[b].node_temperature.size(); ++n)
      EXPECT_NEAR(bodies_of_part[b].node_temperature[n], bodies_of_whole[b].node_temperature[n], tolerance);
  }
}

TEST(BodiesOfAllRoles, RanksAgree) {
  const Lattice lattice = block();
  Surrounded around(lattice);
  expect_ranks_agree(
      lattice, [&] { return Surrounded(lattice).bodies; },
      [&](const LatticeBody& body, const Lattice& l) { return around.points(body, l); });
}

/// Two particles and one tetrahedron or one node: some ranks have no particle, some no node.
TEST(BodiesOfAllRoles, RanksWithoutParticlesAndRanksWithoutNodes) {
  Lattice few = block();
  few.count = {2, 1, 1};
  few.jitter = 0;
  const auto tetrahedron = [] {
    SimplexMesh mesh;
    mesh.nodes = {{0, 0, 0}, {2 * mm, 0, 0}, {0, 2 * mm, 0}, {0, 0, -2 * mm}};
    mesh.elements = {{0, 2, 1, 3}};
    extract_surface(mesh);
    check_mesh(mesh);
    std::vector<RigidHeat> bodies{meshed(mesh, steel(), {}, 500)};
    bodies[0].interface_conductance = 1e4;
    return bodies;
  };
  const auto lumped = [] {
    std::vector<RigidHeat> bodies(1);
    bodies[0].role = Role::LumpedNode;
    bodies[0].temperature = 500;
    bodies[0].heat_capacity = 0.01;
    bodies[0].interface_conductance = 1e4;
    return bodies;
  };
  const auto below = [](bool mesh) {
    return [mesh](const LatticeBody& body, const Lattice& lattice) {
      std::vector<InterfacePoint> points;
      for (std::size_t i = 0; i < body.particles.owned(); ++i) {
        const Vec3 x = body.particles.vector_at(field::position, i);
        if (x.z > lattice.spacing) continue;
        InterfacePoint point;
        point.particle = static_cast<std::int32_t>(i);
        point.distance = x.z;
        point.area = lattice.spacing * lattice.spacing;
        point.heat = 1e-5;
        const double a = x.x / (2 * mm), b = x.y / (2 * mm);
        if (mesh) point.nodes = {{0, 1 - a - b}, {1, a}, {2, b}};
        points.push_back(point);
      }
      return points;
    };
  };
  expect_ranks_agree(few, tetrahedron, below(true));
  expect_ranks_agree(few, lumped, below(false));
  Lattice many = block();
  many.count = {3, 3, 3};
  expect_ranks_agree(many, lumped, below(false));
}

}  // namespace
}  // namespace stirsph
