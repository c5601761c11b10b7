/// Conservation of the heat solve: every joule is found again, with k(T), c_p(T), lumped bodies, films and
/// surroundings; and a solve that fails stops all ranks (E2, E4, E5, E9 of the catalogue in one module).
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <limits>
#include <numbers>
#include <random>
#include <vector>

#include "support/lattice.hpp"
#include "thermal/heat_solver.hpp"

namespace stirsph {
namespace {

using testing::Lattice;
using testing::LatticeBody;
using Role = RigidHeat::Role;
constexpr double infinite = std::numeric_limits<double>::infinity();

/// The paper's alloy, table 2; fits in kelvin.
ThermalProperties alloy() { return {{{7.62, 0.995, -17e-4, 1e-6}, 250, 900}, {{706.7, 0.6, -1e-4}, 250, 900}}; }

HeatSettings settings_for(const Lattice& lattice) {
  HeatSettings settings;
  settings.spacing = lattice.spacing;
  settings.smoothing_length = lattice.h_over_dx * lattice.spacing;
  return settings;
}

Lattice block() {
  Lattice lattice;
  lattice.count = {14, 9, 8};
  lattice.spacing = 0.5e-3;
  lattice.density = 2705;
  lattice.jitter = 0.1;
  return lattice;
}

/// Temperatures and heat input by id, so that they do not depend on the ranks.
void randomise(LatticeBody& body) {
  for (std::size_t i = 0; i < body.particles.owned(); ++i) {
    std::mt19937_64 random(7919 * static_cast<std::uint64_t>(body.particles[field::id][i]) + 1);
    body.particles[field::temperature][i] = std::uniform_real_distribution<double>(300, 750)(random);
    body.particles[field::heat_input][i] = std::uniform_real_distribution<double>(0, 1e-3)(random);
  }
}

/// Contacts of the particles near the planes x = 0 (body 0), x = end (body 1) and z = 0 (body 2).
std::vector<InterfacePoint> box_contacts(const LatticeBody& body, const Lattice& lattice, bool with_bottom = true) {
  std::vector<InterfacePoint> contacts;
  const double end = lattice.count[0] * lattice.spacing;
  for (std::size_t i = 0; i < body.particles.owned(); ++i) {
    const Vec3 x = body.particles.vector_at(field::position, i);
    const double distances[3] = {x.x, end - x.x, x.z};
    for (int b = 0; b < (with_bottom ? 3 : 2); ++b)
      if (distances[b] < 0.85 * lattice.spacing) {
        InterfacePoint contact;
        contact.particle = static_cast<std::int32_t>(i);
        contact.body = b;
        contact.distance = distances[b];
        contact.area = std::pow(lattice.spacing, lattice.dim - 1);
        contacts.push_back(contact);
      }
  }
  return contacts;
}

std::vector<RigidHeat> three_bodies() {
  std::vector<RigidHeat> bodies(3);
  bodies[0].role = Role::LumpedNode;
  bodies[0].temperature = 320;
  bodies[0].heat_capacity = 5;
  bodies[0].ambient_conductance = 0.8;
  bodies[0].ambient_temperature = 293.15;
  bodies[0].interface_conductance = 1e4;
  bodies[1].role = Role::FixedTemperature;
  bodies[1].temperature = 400;
  bodies[1].interface_conductance = infinite;
  bodies[2].role = Role::LumpedNode;
  bodies[2].temperature = 600;
  bodies[2].heat_capacity = 0.01;
  bodies[2].interface_conductance = infinite;
  return bodies;
}

double enthalpy(const LatticeBody& body, const ThermalProperties& material) {
  double sum = 0;
  for (std::size_t i = 0; i < body.particles.owned(); ++i)
    sum += body.particles[field::mass][i] * material.specific_heat.integral(300, body.particles[field::temperature][i]);
  return Comm().sum(sum);
}

TEST(HeatBalance, EveryJouleIsFoundAgain) {
  using Scheme = HeatSettings::Scheme;
  for (const Scheme scheme : {Scheme::BackwardEuler, Scheme::CrankNicolson})
    for (const int iterations : {1, 6}) {
      const Lattice lattice = block();
      LatticeBody body(Comm(), lattice, HeatSolver::add_fields);
      randomise(body);
      auto bodies = three_bodies();
      auto contacts = box_contacts(body, lattice);
      HeatSettings settings = settings_for(lattice);
      settings.scheme = scheme;
      settings.nonlinear_iterations = iterations;
      settings.relative_tolerance = 1e-6;
      HeatSolver solver(Comm(), CubicSpline{}, 3, settings, {alloy()});
      for (int step = 0; step < 3; ++step) {
        // Friction heat of the bodies, known on the rank that made it only.
        double friction = 0;
        for (InterfacePoint& contact : contacts) friction += contact.heat = 1e-4 * (contact.body + 1);
        const double particles_before = enthalpy(body, alloy());
        const double bodies_before =
            bodies[0].heat_capacity * bodies[0].temperature + bodies[2].heat_capacity * bodies[2].temperature;
        const double source = Comm().sum(friction) + Comm().sum([&] {
          double sum = 0;
          for (std::size_t i = 0; i < body.particles.owned(); ++i) sum += body.particles[field::heat_input][i];
          return sum;
        }());
        const HeatReport report = solver.advance(body.particles, body.pairs, body.halo, contacts, bodies, 0.02);
        const double scale = std::abs(report.particle_heat) + std::abs(report.rigid_heat) +
                             std::abs(report.fixed_heat) + std::abs(report.ambient_heat) + report.source_heat;
        const double tolerance = 1e-11 * scale;  // rounding: the balance does not rest on the solver's tolerance
        EXPECT_NEAR(report.particle_heat + report.rigid_heat + report.fixed_heat + report.ambient_heat,
                    report.source_heat, tolerance);
        EXPECT_NEAR(report.source_heat, source, 1e-12 * scale);
        // The report is what happened to the fields.
        EXPECT_NEAR(enthalpy(body, alloy()) - particles_before, report.particle_heat, tolerance);
        EXPECT_NEAR(bodies[0].heat_capacity * bodies[0].temperature + bodies[2].heat_capacity * bodies[2].temperature -
                        bodies_before,
                    report.rigid_heat, tolerance);
        EXPECT_GT(report.iterations, 0);
        EXPECT_LE(report.residual, settings.relative_tolerance);
        for (std::size_t i = 0; i < body.particles.owned(); ++i) EXPECT_EQ(body.particles[field::heat_input][i], 0);
      }
      std::vector<double> agreed{bodies[0].temperature, -bodies[0].temperature};
      Comm().max_in_place(agreed);
      EXPECT_EQ(agreed[0], -agreed[1]) << "a lumped temperature is the same on all ranks";
    }
}

/// A body moving past a lumped tool: contacts and pattern change every step, the balance of an insulated system holds.
TEST(HeatBalance, InsulatedSystemWithChangingContactsKeepsItsHeat) {
  const Lattice lattice = block();
  LatticeBody body(Comm(), lattice, HeatSolver::add_fields);
  randomise(body);
  for (double& heat : body.particles[field::heat_input]) heat = 0;
  std::vector<RigidHeat> bodies(1);
  bodies[0].role = Role::LumpedNode;
  bodies[0].temperature = 293.15;
  bodies[0].heat_capacity = 0.3;
  bodies[0].interface_conductance = 2e4;
  HeatSettings settings = settings_for(lattice);
  HeatSolver solver(Comm(), CubicSpline{}, 3, settings, {alloy()});
  const double start = enthalpy(body, alloy()) + bodies[0].heat_capacity * bodies[0].temperature;
  double moved = 0;
  for (int step = 0; step < 6; ++step) {
    std::vector<InterfacePoint> contacts;
    for (std::size_t i = 0; i < body.particles.owned(); ++i) {
      const Vec3 x = body.particles.vector_at(field::position, i);
      if (x.z < 0.85 * lattice.spacing && std::abs(x.x - step * lattice.spacing) < 2 * lattice.spacing)
        contacts.push_back({static_cast<std::int32_t>(i), 0, x.z, lattice.spacing * lattice.spacing});
    }
    const HeatReport report = solver.advance(body.particles, body.pairs, body.halo, contacts, bodies, 0.01);
    moved += std::abs(report.particle_heat);
  }
  const double end = enthalpy(body, alloy()) + bodies[0].heat_capacity * bodies[0].temperature;
  EXPECT_GT(moved, 0);
  EXPECT_NEAR(end, start, 1e-12 * start);
}

/// Film: with a huge conductivity the particles share one temperature T and lose heat to a wall through h_c only:
/// backward Euler gives (T - Tw)' = (T - Tw) / (1 + h_c A dt / C).
TEST(HeatBalance, FilmBoundary) {
  Lattice lattice = block();
  lattice.jitter = 0;
  lattice.periodic = {false, true, true};
  LatticeBody body(Comm(), lattice, HeatSolver::add_fields);
  for (double& t : body.particles[field::temperature]) t = 700;
  std::vector<RigidHeat> bodies(2);
  bodies[0].role = Role::FixedTemperature;
  bodies[0].temperature = 300;
  bodies[0].interface_conductance = 147;
  const auto contacts = box_contacts(body, lattice, false);
  HeatSettings settings = settings_for(lattice);
  settings.relative_tolerance = 1e-12;
  HeatSolver solver(Comm(), CubicSpline{}, 3, settings, {{{{1e7}}, {{875}}}});
  const double area = lattice.spacing * lattice.spacing * lattice.count[1] * lattice.count[2];
  const double capacity = 875 * lattice.density * area * lattice.count[0] * lattice.spacing;
  double expected = 400;
  for (int step = 0; step < 5; ++step) {
    const HeatReport report = solver.advance(body.particles, body.pairs, body.halo, contacts, bodies, 2.0);
    const double lost = expected - expected / (1 + 147 * area * 2.0 / capacity);
    expected -= lost;
    EXPECT_NEAR(report.fixed_heat, capacity * lost, 1e-5 * capacity * lost);
  }
  for (std::size_t i = 0; i < body.particles.owned(); ++i)
    EXPECT_NEAR(body.particles[field::temperature][i] - 300, expected, 0.01);
}

/// Particles between two fixed temperatures until nothing changes: the flux is that of films and conduction in series
/// (as E4), and with k(T) that of Kirchhoff's integral (E5).
double steady_flux(const ThermalProperties& material, double low, double high, double film, double* middle = nullptr) {
  Lattice lattice;
  lattice.count = {20, 6, 6};
  lattice.periodic = {false, true, true};
  lattice.spacing = 0.5e-3;
  lattice.density = 2785;
  LatticeBody body(Comm(), lattice, HeatSolver::add_fields);
  for (double& t : body.particles[field::temperature]) t = 0.5 * (low + high);
  std::vector<RigidHeat> bodies(2);
  for (int b = 0; b < 2; ++b) {
    bodies[b].role = Role::FixedTemperature;
    bodies[b].temperature = b == 0 ? low : high;
    bodies[b].interface_conductance = film;
  }
  const auto contacts = box_contacts(body, lattice, false);
  HeatSettings settings = settings_for(lattice);
  settings.relative_tolerance = 1e-11;
  settings.nonlinear_iterations = 30;
  HeatSolver solver(Comm(), CubicSpline{}, 3, settings, {material});
  for (int step = 0; step < 12; ++step) solver.advance(body.particles, body.pairs, body.halo, contacts, bodies, 50);
  // Flux into the low side: from the face particles' temperature over half a cell would be first order; take the mean
  // of k dT/dx by the Kirchhoff transform between two planes well inside.
  const TemperaturePolynomial& k = material.conductivity;
  const auto x = body.particles.component(field::position, 0);
  std::vector<double> sums(5, 0.0);
  for (std::size_t i = 0; i < body.particles.owned(); ++i) {
    const double t = body.particles[field::temperature][i];
    const int plane = static_cast<int>(x[i] / lattice.spacing);
    if (plane == 4) sums[0] += k.integral(low, t) / 36;
    if (plane == 15) sums[1] += k.integral(low, t) / 36;
    if (plane == 9 || plane == 10) sums[2] += t / 72;
  }
  Comm().sum_in_place(sums);
  if (middle) *middle = sums[2];
  return (sums[1] - sums[0]) / (11 * lattice.spacing);
}

TEST(SteadyHeat, FilmsInSeries) {
  const double flux = steady_flux({{{188}}, {{875}}}, 300, 700, 1e4);
  EXPECT_NEAR(flux / (400 / (2e-4 + 0.01 / 188)), 1, 1e-6);
}

TEST(SteadyHeat, KirchhoffE5) {
  double middle = 0;
  const double flux = steady_flux(alloy(), 300, 750, infinite, &middle);
  EXPECT_NEAR(flux / 9181181, 1, 1e-3);
  EXPECT_NEAR(middle, 532.631, 0.5);
}

TEST(HeatFailure, TooFewIterationsThrowOnEveryRank) {
  const Lattice lattice = block();
  LatticeBody body(Comm(), lattice, HeatSolver::add_fields);
  randomise(body);
  std::vector<double> before(body.particles[field::temperature].begin(), body.particles[field::temperature].end());
  auto bodies = three_bodies();
  HeatSettings settings = settings_for(lattice);
  settings.maximum_iterations = 1;
  HeatSolver solver(Comm(), CubicSpline{}, 3, settings, {alloy()});
  bool thrown = false;
  try {
    solver.advance(body.particles, body.pairs, body.halo, box_contacts(body, lattice), bodies, 0.05);
  } catch (const SolverError& error) {
    thrown = true;
    EXPECT_NE(std::string(error.what()).find("DIVERGED_ITS after 1 iterations"), std::string::npos) << error.what();
    EXPECT_EQ(error.code(), ExitCode::Solver);
  }
  EXPECT_TRUE(thrown);
  EXPECT_FALSE(Comm().any(!thrown));
  for (std::size_t i = 0; i < body.particles.owned(); ++i)
    EXPECT_EQ(body.particles[field::temperature][i], before[i]) << "a failed solve leaves the temperatures alone";
}

TEST(HeatFailure, NotANumberIsReported) {
  const Lattice lattice = block();
  LatticeBody body(Comm(), lattice, HeatSolver::add_fields);
  randomise(body);
  if (body.particles.owned() > 0 && Comm().is_root()) body.particles[field::heat_input][0] = std::nan("");
  HeatSolver solver(Comm(), CubicSpline{}, 3, settings_for(lattice), {alloy()});
  EXPECT_THROW(solver.advance(body.particles, body.pairs, body.halo, {}, {}, 0.05), SolverError);
}

TEST(HeatFailure, FrictionHeatOfAnInsulatedBodyIsRefused) {
  const Lattice lattice = block();
  LatticeBody body(Comm(), lattice, HeatSolver::add_fields);
  randomise(body);
  std::vector<RigidHeat> bodies(1);
  std::vector<InterfacePoint> contacts(Comm().is_root() ? 1 : 0);
  for (InterfacePoint& contact : contacts) contact.heat = 1;
  HeatSolver solver(Comm(), CubicSpline{}, 3, settings_for(lattice), {alloy()});
  try {
    solver.advance(body.particles, body.pairs, body.halo, contacts, bodies, 0.05);
    FAIL() << "heat for a body that takes none would vanish";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::Input);
    EXPECT_NE(std::string(error.what()).find("is insulated but received 1 J"), std::string::npos) << error.what();
  }
}

/// The answer does not depend on the ranks: every rank also solves the whole problem alone, and compares its particles.
TEST(HeatBalance, RanksAgree) {
  const Lattice lattice = block();
  HeatSettings settings = settings_for(lattice);
  settings.relative_tolerance = 1e-12;
  const auto solve_on = [&](const Comm& comm, LatticeBody& body, std::vector<RigidHeat>& bodies) {
    randomise(body);
    HeatSolver solver(comm, CubicSpline{}, 3, settings, {alloy()});
    const auto contacts = box_contacts(body, lattice);
    for (int step = 0; step < 3; ++step) solver.advance(body.particles, body.pairs, body.halo, contacts, bodies, 0.02);
  };
  const Comm alone(MPI_COMM_SELF), all;
  LatticeBody whole(alone, lattice, HeatSolver::add_fields), part(all, lattice, HeatSolver::add_fields);
  auto bodies_of_whole = three_bodies(), bodies_of_part = three_bodies();
  solve_on(alone, whole, bodies_of_whole);
  solve_on(all, part, bodies_of_part);
  std::vector<double> expected(whole.particles.owned());
  for (std::size_t i = 0; i < expected.size(); ++i)
    expected[static_cast<std::size_t>(whole.particles[field::id][i])] = whole.particles[field::temperature][i];
  for (std::size_t i = 0; i < part.particles.owned(); ++i)
    EXPECT_NEAR(part.particles[field::temperature][i], expected[static_cast<std::size_t>(part.particles[field::id][i])],
                1e-7);
  EXPECT_NEAR(bodies_of_part[0].temperature, bodies_of_whole[0].temperature, 1e-8);
  EXPECT_NEAR(bodies_of_part[2].temperature, bodies_of_whole[2].temperature, 1e-7);
}

/// More ranks than the particles can fill: a rank without particles takes part, also when it is the one with the nodes.
TEST(HeatBalance, HandfulOfParticles) {
  Lattice lattice = block();
  lattice.count = {2, 1, 1};
  lattice.jitter = 0;
  LatticeBody body(Comm(), lattice, HeatSolver::add_fields);
  for (double& t : body.particles[field::temperature]) t = 700;
  auto bodies = three_bodies();
  HeatSolver solver(Comm(), CubicSpline{}, 3, settings_for(lattice), {alloy()});
  const HeatReport report =
      solver.advance(body.particles, body.pairs, body.halo, box_contacts(body, lattice), bodies, 0.02);
  EXPECT_LT(report.particle_heat, 0);
  EXPECT_NEAR(report.particle_heat + report.rigid_heat + report.fixed_heat + report.ambient_heat, 0,
              1e-12 * std::abs(report.particle_heat) + 1e-12);
}

}  // namespace
}  // namespace stirsph
