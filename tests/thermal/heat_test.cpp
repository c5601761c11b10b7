/// Accuracy of the heat solve: the operator on a lattice (A1, A4), a slab between fixed temperatures (E1), order in
/// time (E8).
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <numbers>
#include <vector>

#include "support/lattice.hpp"
#include "thermal/conduction.hpp"
#include "thermal/heat_solver.hpp"

namespace stirsph {
namespace {

using testing::Lattice;
using testing::LatticeBody;
constexpr double pi = std::numbers::pi;

/// The aluminium of the catalogue.
constexpr double density = 2785;
ThermalProperties aluminium() { return {{{188}}, {{875}}}; }
constexpr double diffusivity = 188 / (density * 875);

HeatSettings settings_for(const Lattice& lattice) {
  HeatSettings settings;
  settings.spacing = lattice.spacing;
  settings.smoothing_length = lattice.h_over_dx * lattice.spacing;
  return settings;
}

/// Sets T(x) on owned particles.
template <class Profile>
void set_temperature(LatticeBody& body, Profile&& profile) {
  for (std::size_t i = 0; i < body.particles.owned(); ++i)
    body.particles[field::temperature][i] = profile(body.particles.component(field::position, 0)[i]);
  body.halo.exchange(body.particles, Halo::Thermal);
}

/// sum T w / sum w^2 with w = cos(k x) over all ranks: the amplitude of the mode.
double amplitude(const LatticeBody& body, double wave_number) {
  std::vector<double> sums(2, 0.0);
  for (std::size_t i = 0; i < body.particles.owned(); ++i) {
    const double w = std::cos(wave_number * body.particles.component(field::position, 0)[i]);
    sums[0] += body.particles[field::temperature][i] * w;
    sums[1] += w * w;
  }
  Comm().sum_in_place(sums);
  return sums[0] / sums[1];
}

TEST(ThermalProperties, IntegralIsExact) {
  const TemperaturePolynomial c{{706.7, 0.6, -1e-4}, 250, 900};
  const auto primitive = [](double t) { return 706.7 * t + 0.3 * t * t - 1e-4 / 3 * t * t * t; };
  EXPECT_NEAR(c.integral(300, 800), primitive(800) - primitive(300), 1e-9 * primitive(800));
  EXPECT_NEAR(c.integral(800, 300), -c.integral(300, 800), 1e-9);
  EXPECT_NEAR(c.integral(200, 1000), primitive(900) - primitive(250) + 50 * c(250) + 100 * c(900), 1e-6);
  EXPECT_NEAR(c.integral(950, 1000), 50 * c(900), 1e-9);
  EXPECT_NEAR(c.integral(500, 500 + 1e-9) / (c(500) * ((500 + 1e-9) - 500)), 1, 1e-11);
}

TEST(LatticeSums, BulkFactorsOfCaseA1) {
  EXPECT_NEAR(lattice_conduction_factor(CubicSpline{}, 3, 1.3) - 1, -6.516300e-3, 1e-9);
  EXPECT_NEAR(lattice_conduction_factor(CubicSpline{}, 3, 1.2) - 1, -1.831143e-2, 1e-8);
  EXPECT_NEAR(lattice_conduction_factor(WendlandC2{}, 3, 1.5) - 1, 6.193001e-4, 1e-9);
  EXPECT_NEAR(lattice_conduction_factor(WendlandC2{}, 3, 2.0) - 1, -5.872911e-4, 1e-9);
  EXPECT_NEAR(lattice_conduction_factor(QuinticSpline{}, 3, 1.0) - 1, 1.001281e-3, 1e-8);
  EXPECT_NEAR(lattice_kernel_sum(CubicSpline{}, 3, 1.3) - 1, -2.738172e-3, 1e-8);
  EXPECT_NEAR(lattice_kernel_sum(WendlandC2{}, 3, 1.5) - 1, 3.141083e-3, 1e-8);
}

/// Against an independent script's solution of the half-space of planes.
TEST(LatticeSums, SurfaceResistance) {
  EXPECT_NEAR(lattice_surface_resistance(CubicSpline{}, 3, 1.3), -0.0628, 6e-5);
  EXPECT_NEAR(lattice_surface_resistance(CubicSpline{}, 3, 1.2), -0.0853, 6e-5);
  EXPECT_NEAR(lattice_surface_resistance(WendlandC2{}, 3, 1.5), -0.0380, 6e-5);
  EXPECT_NEAR(lattice_surface_resistance(WendlandC2{}, 3, 2.0), 0.0945, 6e-5);
}

/// A4: the operator applied to cos(k x) on a periodic lattice, over -k^2 times the field; the table is without M.
TEST(ConductionOperator, CosineOnLatticeA4) {
  struct Case {
    Kernel kernel;
    double h, support;
    std::array<double, 4> expected;
  };
  const std::array<int, 4> wavelengths{4, 8, 16, 40};
  const std::vector<Case> cases{{CubicSpline{}, 1.3, 2, {0.73250, 0.91847, 0.97403, 0.99034}},
                                {WendlandC2{}, 1.5, 2, {0.69642, 0.91089, 0.97720, 0.99683}},
                                {QuinticSpline{}, 1.0, 3, {0.75718, 0.93199, 0.98318, 0.99812}}};
  for (const Case& c : cases)
    for (std::size_t w = 0; w < wavelengths.size(); ++w) {
      Lattice lattice;
      lattice.count = {std::max(wavelengths[w], 8), 8, 8};
      lattice.periodic = {true, true, true};
      lattice.spacing = 0.5e-3;
      lattice.h_over_dx = c.h;
      lattice.support = c.support;
      LatticeBody body(Comm(), lattice, HeatSolver::add_fields);
      const ConductionOperator op{c.kernel, lattice_conduction_factor(c.kernel, 3, c.h),
                                  lattice_kernel_sum(c.kernel, 3, c.h)};
      const double k = 2 * pi / (wavelengths[w] * lattice.spacing);
      for (double& value : body.particles[field::conductivity]) value = 188;
      HeatGraph graph;
      graph.build(body.particles, body.pairs, op);
      set_temperature(body, [&](double x) { return std::cos(k * x); });
      const auto power = conduction_power(body.particles, graph);
      std::vector<double> sums(2, 0.0);
      for (std::size_t i = 0; i < body.particles.owned(); ++i) {
        const double t = body.particles[field::temperature][i];
        sums[0] -= power[i] * t;
        sums[1] += 188 * k * k * t * t * body.particles[field::volume][i];
      }
      Comm().sum_in_place(sums);
      EXPECT_NEAR(sums[0] / sums[1] * op.lattice_factor, c.expected[w], 6e-6) << wavelengths[w];
    }
}

/// A field of uniform temperature stays put to the last bit, whatever the arrangement.
TEST(ConductionOperator, UniformFieldHasNoFlux) {
  Lattice lattice;
  lattice.count = {9, 7, 8};
  lattice.periodic = {false, true, false};
  lattice.jitter = 0.2;
  LatticeBody body(Comm(), lattice, HeatSolver::add_fields);
  HeatSolver solver(Comm(), CubicSpline{}, 3, settings_for(lattice), {aluminium()});
  set_temperature(body, [](double) { return 412.7; });
  solver.advance(body.particles, body.pairs, body.halo, {}, {}, 1e3);
  for (std::size_t i = 0; i < body.particles.owned(); ++i) EXPECT_EQ(body.particles[field::temperature][i], 412.7);
}

/// Heat along a thin insulated plate: without the surface correction the faces conduct too little, by 0.23 dx each.
TEST(ConductionOperator, ThinPlateConductsAlongItsFaces) {
  Lattice lattice;
  lattice.count = {40, 8, 8};
  lattice.periodic = {true, true, false};
  LatticeBody body(Comm(), lattice, HeatSolver::add_fields);
  ConductionOperator op{CubicSpline{}, lattice_conduction_factor(CubicSpline{}, 3, 1.3),
                        lattice_kernel_sum(CubicSpline{}, 3, 1.3)};
  for (double& value : body.particles[field::conductivity]) value = 1;
  HeatGraph graph;
  graph.build(body.particles, body.pairs, op);
  const std::vector<double> corrections(body.particles[field::conduction_correction].begin(),
                                        body.particles[field::conduction_correction].end());
  const double k = 2 * pi / 40;
  const auto ratio = [&] {
    set_temperature(body, [&](double x) { return std::cos(k * x); });
    const auto power = conduction_power(body.particles, graph);
    std::vector<double> sums(2, 0.0);
    for (std::size_t i = 0; i < body.particles.owned(); ++i) {
      sums[0] -= power[i] * body.particles[field::temperature][i];
      sums[1] += std::pow(k * body.particles[field::temperature][i], 2);
    }
    Comm().sum_in_place(sums);
    return sums[0] / sums[1];
  };
  const double bulk = 0.99034 / 0.99348;
  for (double& value : body.particles[field::conduction_correction]) value = 1;
  const double plain = ratio() / bulk - 1;
  std::copy(corrections.begin(), corrections.end(), body.particles[field::conduction_correction].begin());
  const double corrected = ratio() / bulk - 1;
  if (Comm().is_root())
    std::printf("plate of 8 particles, conductance along it: plain %+.2f %%, corrected %+.2f %%\n", 100 * plain,
                100 * corrected);
  EXPECT_LT(plain, -0.05);
  EXPECT_LT(std::abs(corrected), 0.005);
}

/// T in a slab |x| < L, initially 0, faces held at 1 from t = 0.
double slab_exact(double x, double length, double t) {
  double sum = 0;
  for (int n = 0; n < 60; ++n) {
    const double b = (n + 0.5) * pi / length;
    sum += (n % 2 ? -1 : 1) * 2 / (b * length) * std::exp(-b * b * diffusivity * t) * std::cos(b * x);
  }
  return 1 - sum;
}

/// Relative L2 error of case E1 after 0.5 s. Crank-Nicolson after two short Euler steps, so that only the error in
/// space counts.
double slab_error(int half_count, int dim, const Kernel& kernel, double h_over_dx, double jitter = 0) {
  const double half = 0.01;
  Lattice lattice;
  lattice.count = {2 * half_count, 6, 6};
  lattice.periodic = {false, true, true};
  lattice.spacing = half / half_count;
  lattice.h_over_dx = h_over_dx;
  lattice.density = density;
  lattice.dim = dim;
  lattice.jitter = jitter;
  LatticeBody body(Comm(), lattice, HeatSolver::add_fields);
  ParticleSet& particles = body.particles;
  std::vector<RigidHeat> walls(2);
  for (RigidHeat& wall : walls) {
    wall.role = RigidHeat::Role::FixedTemperature;
    wall.temperature = 1;
    wall.interface_conductance = std::numeric_limits<double>::infinity();
  }
  const auto x = particles.component(field::position, 0);
  std::vector<InterfacePoint> contacts;
  for (std::size_t i = 0; i < particles.owned(); ++i)
    for (int side = 0; side < 2; ++side) {
      const double distance = side == 0 ? x[i] : 2 * half - x[i];
      if (particles[field::id][i] >= 0 && distance < 0.9 * lattice.spacing) {
        InterfacePoint contact;
        contact.particle = static_cast<std::int32_t>(i);
        contact.body = side;
        contact.distance = distance;
        contact.area = std::pow(lattice.spacing, dim - 1);
        contacts.push_back(contact);
      }
    }
  HeatSettings settings = settings_for(lattice);
  settings.relative_tolerance = 1e-10;
  HeatSolver first(Comm(), kernel, dim, settings, {aluminium()});
  settings.scheme = HeatSettings::Scheme::CrankNicolson;
  HeatSolver solver(Comm(), kernel, dim, settings, {aluminium()});
  const double end = 0.5;
  const int steps = 200;
  for (int n = 0; n < 4; ++n) first.advance(particles, body.pairs, body.halo, contacts, walls, end / steps / 4);
  for (int n = 1; n < steps; ++n) solver.advance(particles, body.pairs, body.halo, contacts, walls, end / steps);
  std::vector<double> sums(2, 0.0);
  for (std::size_t i = 0; i < particles.owned(); ++i) {
    const double exact = slab_exact(x[i] - half, half, end), error = particles[field::temperature][i] - exact;
    sums[0] += error * error;
    sums[1] += exact * exact;
  }
  Comm().sum_in_place(sums);
  return std::sqrt(sums[0] / sums[1]);
}

void check_slab(const char* name, int dim, const Kernel& kernel, double h) {
  const double e10 = slab_error(10, dim, kernel, h), e20 = slab_error(20, dim, kernel, h),
               e40 = slab_error(40, dim, kernel, h);
  if (Comm().is_root())
    std::printf("slab E1, %s %d-D: L2 error %.3e %.3e %.3e at 10, 20, 40 particles, order %.2f %.2f\n", name, dim, e10,
                e20, e40, std::log2(e10 / e20), std::log2(e20 / e40));
  EXPECT_LT(e20, 0.01);
  EXPECT_GE(std::log2(e10 / e40) / 2, 1.7);
}

TEST(Slab, ExactSolutionOfTheCatalogue) {
  EXPECT_NEAR(slab_exact(0, 0.01, 0.2), 0.143675, 1e-6);
  EXPECT_NEAR(slab_exact(0, 0.01, 0.5), 0.508540, 1e-6);
  EXPECT_NEAR(slab_exact(0.005, 0.01, 1.0), 0.865818, 1e-6);
}
TEST(Slab, FixedFacesCubic) { check_slab("cubic 1.3", 3, CubicSpline{}, 1.3); }
TEST(Slab, FixedFacesCubicTwoDimensions) { check_slab("cubic 1.3", 2, CubicSpline{}, 1.3); }
TEST(Slab, FixedFacesWendland) { check_slab("Wendland C2 1.5", 3, WendlandC2{}, 1.5); }
TEST(Slab, FixedFacesJittered) {
  const double e20 = slab_error(20, 3, CubicSpline{}, 1.3, 0.1);
  if (Comm().is_root()) std::printf("slab E1, cubic 1.3 3-D, 10 %% jitter: L2 error %.3e at 20 particles\n", e20);
  EXPECT_LT(e20, 0.03);
}

/// E8: decay of one mode of an insulated, here periodic, bar: amplitude after one step and after t = 1/lambda.
TEST(TimeScheme, DecayFactorsE8) {
  Lattice lattice;
  lattice.count = {16, 8, 8};
  lattice.periodic = {true, true, true};
  lattice.spacing = 1e-3;
  lattice.density = density;
  const double k = 2 * pi / (16 * lattice.spacing);
  // lambda of the operator: A4's ratio, computed here to all digits from the operator itself.
  LatticeBody probe(Comm(), lattice, HeatSolver::add_fields);
  const ConductionOperator op{CubicSpline{}, lattice_conduction_factor(CubicSpline{}, 3, 1.3),
                              lattice_kernel_sum(CubicSpline{}, 3, 1.3)};
  for (double& value : probe.particles[field::conductivity]) value = 188;
  HeatGraph graph;
  graph.build(probe.particles, probe.pairs, op);
  set_temperature(probe, [&](double x) { return std::cos(k * x); });
  const auto power = conduction_power(probe.particles, graph);
  double rate = 0;
  for (std::size_t i = 0; i < probe.particles.owned(); ++i)
    rate -= power[i] * probe.particles[field::temperature][i] / (probe.particles[field::mass][i] * 875);
  const double lambda = Comm().sum(rate) / (16 * 8 * 8 / 2);
  EXPECT_NEAR(lambda / (diffusivity * k * k), 0.97403 / (1 - 6.5163e-3), 1e-5);

  using Scheme = HeatSettings::Scheme;
  for (const Scheme scheme : {Scheme::BackwardEuler, Scheme::CrankNicolson})
    for (const double step : {0.1, 0.025}) {
      LatticeBody body(Comm(), lattice, HeatSolver::add_fields);
      HeatSettings settings = settings_for(lattice);
      settings.relative_tolerance = 1e-12;
      settings.scheme = scheme;
      HeatSolver solver(Comm(), CubicSpline{}, 3, settings, {aluminium()});
      set_temperature(body, [&](double x) { return 500 + 100 * std::cos(k * x); });
      const int steps = static_cast<int>(std::lround(1 / step));
      for (int n = 0; n < steps; ++n) solver.advance(body.particles, body.pairs, body.halo, {}, {}, step / lambda);
      const bool euler = scheme == Scheme::BackwardEuler;
      const double exact = euler ? std::pow(1 + step, -steps) : std::pow((1 - step / 2) / (1 + step / 2), steps);
      const double factor = amplitude(body, k) / 100;
      EXPECT_NEAR(factor, exact, 1e-8);
      const double table = euler ? (step == 0.1 ? 0.385543 : 0.372431) : (step == 0.1 ? 0.367573 : 0.367860);
      EXPECT_NEAR(factor, table, 1e-6);
    }
}

/// E8 in an insulated slab with free faces, one huge backward Euler step: no value leaves the initial range.
TEST(TimeScheme, HugeEulerStepDoesNotOvershoot) {
  Lattice lattice;
  lattice.count = {24, 6, 6};
  lattice.density = density;
  lattice.spacing = 1e-3;
  LatticeBody body(Comm(), lattice, HeatSolver::add_fields);
  HeatSolver solver(Comm(), CubicSpline{}, 3, settings_for(lattice), {aluminium()});
  const double k = pi / (24 * lattice.spacing);
  set_temperature(body, [&](double x) { return 500 + 100 * std::cos(k * x); });
  solver.advance(body.particles, body.pairs, body.halo, {}, {}, 1e3 / (diffusivity * k * k));
  const auto x = body.particles.component(field::position, 0);
  for (std::size_t i = 0; i < body.particles.owned(); ++i) {
    const double rise = body.particles[field::temperature][i] - 500;
    EXPECT_LT(std::abs(rise), 0.2);               // 100/1001 left
    EXPECT_GT(rise * std::cos(k * x[i]), -1e-4);  // nowhere past the mean
  }
}

/// E9: what conducts is symmetric and, with the capacities, positive definite: bit by bit between particles, to
/// rounding between nodes, where links of particles join three of them at a time.
TEST(HeatMatrixE9, LinksOfParticlesAreSymmetricToTheLastBit) {
  Lattice lattice;
  lattice.count = {7, 6, 5};
  lattice.jitter = 0.2;
  LatticeBody body(Comm(MPI_COMM_SELF), lattice, HeatSolver::add_fields);
  for (std::size_t i = 0; i < body.particles.owned(); ++i) {
    body.particles[field::conductivity][i] = 1 + 0.1 * static_cast<double>(i % 7);
    body.particles[field::smoothing_length][i] *= 1 - 0.01 * static_cast<double>(i % 3);
  }
  const ConductionOperator op{CubicSpline{}, 1, 1};
  HeatGraph graph;
  graph.build(body.particles, body.pairs, op);
  const LinkEnds ends(body.particles);
  std::size_t links = 0;
  for (std::size_t i = 0; i < graph.particles(); ++i)
    for (std::size_t k = 0; k < graph.neighbours(i).size(); ++k) {
      const auto j = static_cast<std::size_t>(graph.neighbours(i)[k]);
      const auto back = graph.neighbours(j);
      const auto at = std::lower_bound(back.begin(), back.end(), static_cast<std::int32_t>(i));
      ASSERT_TRUE(at != back.end() && *at == static_cast<std::int32_t>(i));
      const double here = ends.conductance(i, j, graph.factors(i)[k]);
      EXPECT_EQ(here, ends.conductance(j, i, graph.factors(j)[static_cast<std::size_t>(at - back.begin())]));
      EXPECT_GT(here, 0);
      ++links;
    }
  EXPECT_GT(links, 20 * graph.particles());
}

}  // namespace
}  // namespace stirsph
