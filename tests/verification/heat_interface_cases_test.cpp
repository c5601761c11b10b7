/// E2, E3, E9 and D5 of the verification catalogue: heat through the interface of particles and meshes, at rest and
/// sliding, as ordinary scenes.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "support/heat_scene_run.hpp"

namespace stirsph::testing {
namespace {

constexpr double pi = std::numbers::pi;
class InBothSpaces : public ::testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Dimensions, InBothSpaces, ::testing::Values(2, 3),
                         [](const auto& space) { return std::to_string(space.param) + "D"; });

/// exp(x^2) erfc(x); beyond 20 the asymptotic series, good to 1e-9 there.
double scaled_erfc(double x) {
  if (x < 20) return std::exp(x * x) * std::erfc(x);
  return (1 - 0.5 / (x * x) + 0.75 / (x * x * x * x)) / (x * std::sqrt(pi));
}

/// Half spaces of AL at 693.15 K and ST at 293.15 K that touch through a film from t = 0.
struct HalfSpaces {
  double film;
  double hot_effusivity = std::sqrt(2785.0 * 875 * 188), cold_effusivity = std::sqrt(7800.0 * 460 * 24.4);
  double a() const { return film * (1 / hot_effusivity + 1 / cold_effusivity); }
  double flux(double t) const { return film * 400 * scaled_erfc(a() * std::sqrt(t)); }
  double passed(double t) const {
    return film * 400 / (a() * a()) * (scaled_erfc(a() * std::sqrt(t)) - 1 + 2 * a() * std::sqrt(t / pi));
  }
  double hot_drop(double t) const {
    return 400 * cold_effusivity / (hot_effusivity + cold_effusivity) * (1 - scaled_erfc(a() * std::sqrt(t)));
  }
  double cold_rise(double t) const { return hot_drop(t) * hot_effusivity / cold_effusivity; }
};

TEST(HalfSpaces, ExactSolutionOfTheCatalogue) {
  const HalfSpaces weak{147}, middle{1e4}, strong{1e6};
  EXPECT_NEAR(weak.flux(1), 57331.4, 0.1);
  EXPECT_NEAR(middle.passed(0.1), 290199.5, 0.1);
  EXPECT_NEAR(middle.cold_rise(1), 190.4335, 1e-4);
  EXPECT_NEAR(strong.flux(1), 1469252, 1);
  EXPECT_NEAR(strong.hot_drop(1), 121.2235, 1e-4);
}

/// Relative errors at one time.
struct InterfaceErrors {
  double flux, passed, hot_drop, cold_rise;
  double worst() const { return std::max({std::abs(flux), std::abs(passed), std::abs(hot_drop), std::abs(cold_rise)}); }
};

/// Steps a scene with the bodies "hot" and "cold" that touch over `area` [m2] at x = 0 to the time t.
InterfaceErrors compare(Simulation& simulation, const HalfSpaces& exact, double area, double t) {
  const double step = simulation.scene().time.fixed_step;
  run_until(simulation, t - step);
  const double before = history_value(simulation, "cold.interface_heat");
  run_until(simulation, t);
  const double passed = history_value(simulation, "cold.interface_heat");
  // The heat of the last step, over the exact heat of that step.
  return {(passed - before) / area / (exact.passed(t) - exact.passed(t - step)) - 1,
          passed / area / exact.passed(t) - 1, (693.15 - face_temperature(simulation, 0)) / exact.hot_drop(t) - 1,
          (mesh_face_temperature(simulation, 0, 0) - 293.15) / exact.cold_rise(t) - 1};
}

void report(const std::string& name, const InterfaceErrors& e) {
  std::printf("%s: flux %+.2f %%, heat passed %+.2f %%, hot face %+.2f %%, cold face %+.2f %%\n", name.c_str(),
              100 * e.flux, 100 * e.passed, 100 * e.hot_drop, 100 * e.cold_rise);
}

std::unique_ptr<Simulation> half_spaces(double film, double spacing, double mesh_size, int dim) {
  const double half = std::max(1.5e-3, 3 * spacing);
  const Overrides all = touching_columns(-0.022, 0.007, half, dim);
  return started(verification_scene("e2_half_spaces"),
                 joined(all, {override_of("numerics.spacing", spacing, "m"),
                              override_of("rigid.0.heat.conductance", film, "W/m2/K"),
                              override_of("rigid.0.heat.mesh.near", mesh_size, "m"),
                              override_of("rigid.0.heat.mesh.far", std::max(1e-3, mesh_size), "m")}));
}

double area_of_half_spaces(double spacing, int dim) { return std::pow(2 * std::max(1.5e-3, 3 * spacing), dim - 1); }

TEST_P(InBothSpaces, HalfSpacesE2) {
  const int dim = GetParam();
  struct Case {
    double film, mesh_size;
    std::vector<double> times;
  };
  const double spacing = 0.5e-3;
  // Meshes as fine as the particles, finer and coarser.
  for (const Case& c : {Case{147, 0.35e-3, {1}}, Case{1e4, 0.25e-3, {0.1, 1}}, Case{1e4, 0.5e-3, {1}},
                        Case{1e4, 0.75e-3, {1}}, Case{1e6, 0.35e-3, {1}}}) {
    const auto simulation = half_spaces(c.film, spacing, c.mesh_size, dim);
    for (const double t : c.times) {
      const InterfaceErrors e = compare(*simulation, HalfSpaces{c.film}, area_of_half_spaces(spacing, dim), t);
      char name[100];
      std::snprintf(name, sizeof name, "E2, %d-D, mesh %.2f mm, h = %g, %g s", dim, 1e3 * c.mesh_size, c.film, t);
      report(name, e);
      EXPECT_LT(e.worst(), 0.01) << name;
    }
  }
}

/// The interface is where the orders of both bodies and of the links between them meet.
TEST_P(InBothSpaces, HalfSpacesOrderE2) {
  const int dim = GetParam();
  std::array<InterfaceErrors, 2> errors{};
  for (int k = 0; k < 2; ++k) {
    const double spacing = 2e-3 / (k + 1);
    const auto simulation = half_spaces(1e4, spacing, 0.7 * spacing, dim);
    errors[k] = compare(*simulation, HalfSpaces{1e4}, area_of_half_spaces(spacing, dim), 1);
    report("E2, " + std::to_string(dim) + "-D, spacing " + std::to_string(1e3 * spacing) + " mm", errors[k]);
  }
  const double observed = order(errors[0].worst(), errors[1].worst());
  std::printf("E2, %d-D: order of the largest error %.2f\n", dim, observed);
  EXPECT_GT(observed, 1);
}

/// Refining the mesh alone, below the spacing of the particles, may not spoil the answer: heat enters over each
/// particle's footprint. Entering at its foot alone it meets a resistance of a point: -3.5 % here.
TEST(HalfSpacesFineMesh, HeatEntersOverTheFootprintE2) {
  const auto simulation = half_spaces(1e4, 0.5e-3, 0.125e-3, 2);
  const InterfaceErrors e = compare(*simulation, HalfSpaces{1e4}, area_of_half_spaces(0.5e-3, 2), 1);
  report("E2, 2-D, mesh 0.125 mm under particles of 0.5 mm", e);
  EXPECT_LT(e.worst(), 0.01);
}

TEST(HalfSpacesSliding, SameAnswerE2) {
  const double area = pi * std::pow(4.3702e-3, 2);
  std::array<InterfaceErrors, 2> errors{};
  for (int k = 0; k < 2; ++k) {
    const auto simulation =
        started(verification_scene("e2_sliding"), k == 0 ? Overrides{"rigid.0.rotation.rate=0 rpm"} : Overrides{});
    errors[k] = compare(*simulation, HalfSpaces{1e4}, area, 1);
    report(k == 0 ? "E2, disc at rest" : "E2, disc turning, 1.7 m/s at the rim", errors[k]);
    EXPECT_LT(errors[k].worst(), 0.01);
    EXPECT_NEAR(simulation->rigids()[0].pose.angle, k * 1.7 / 4.3702e-3, 1e-6);  // after 1 s
  }
  // At rest the staircase of the particles at the rim leaves parts of the mesh uncovered, which turning evens out.
  EXPECT_LT(std::abs(errors[1].passed - errors[0].passed), 0.01);
  EXPECT_GT(std::abs(errors[1].passed - errors[0].passed), 1e-5);  // so the heat did go to other nodes
}

/// E3: what a thermometer would show at the places of the catalogue.
struct BilletInDie {
  double axis, face, thermocouple;
};

BilletInDie read(const Simulation& simulation) {
  return {probe_values(simulation, "axis")[0], mean(probe_values(simulation, "face")),
          probe_values(simulation, "thermocouple")[0]};
}

double deviation(const BilletInDie& a, const BilletInDie& b) {
  return std::max({std::abs(a.axis - b.axis), std::abs(a.face - b.face), std::abs(a.thermocouple - b.thermocouple)});
}

void report(const char* name, double t, const BilletInDie& is, const BilletInDie& should) {
  std::printf("E3, %s, %g s: axis %.2f (%.2f), die face %.2f (%.2f), thermocouple %.2f (%.2f) K\n", name, t, is.axis,
              should.axis, is.face, should.face, is.thermocouple, should.thermocouple);
}

struct Moment {
  double t;
  BilletInDie reference;
};
/// h = 147 W/m2/K, finite volumes with 900 cells, purely radial.
const std::vector<Moment> weak_film{{1, {670.45, 299.20, 297.25}},
                                    {10, {640.09, 308.23, 306.36}},
                                    {40, {558.17, 317.57, 316.20}},
                                    {100, {455.44, 328.45, 327.72}}};
const std::vector<Moment> strong_film{{1, {586.80, 445.23, 405.06}}};

/// Largest deviation over the moments [K].
double billet_in_die(const char* name, const std::string& scene, const std::vector<Moment>& moments,
                     const Overrides& overrides) {
  const auto simulation = started(verification_scene(scene), overrides);
  double worst = 0;
  for (const Moment& moment : moments) {
    run_until(*simulation, moment.t);
    const BilletInDie is = read(*simulation);
    report(name, moment.t, is, moment.reference);
    worst = std::max(worst, deviation(is, moment.reference));
  }
  return worst;
}

constexpr double one_percent = 0.01 * 380;  // K, of the initial difference: the catalogue's target
const Overrides strong{"rigid.0.heat.conductance=1e4 W/m2/K", "time.end=1 s", "time.step=10 ms"};

TEST(BilletInDie, ThreeDimensionsE3) {
  EXPECT_LT(billet_in_die("3-D, h = 147", "e3_billet_in_die", weak_film, {}), one_percent);
  // Six layers of 0.75 mm.
  const Overrides fine{"numerics.spacing=0.75 mm",
                       "rigid.0.heat.mesh.near=0.6 mm",
                       "domain.low=[\"-15 mm\", \"-15 mm\", \"-2.25 mm\"]",
                       "domain.high=[\"15 mm\", \"15 mm\", \"2.25 mm\"]",
                       "body.0.shape.base=[\"0 mm\", \"0 mm\", \"-2.25 mm\"]",
                       "body.0.shape.height=4.5 mm",
                       "rigid.0.shape.base=[\"0 mm\", \"0 mm\", \"-2.25 mm\"]",
                       "rigid.0.shape.height=4.5 mm"};
  EXPECT_LT(billet_in_die("3-D, h = 1e4", "e3_billet_in_die", strong_film, joined(strong, fine)), one_percent);
}

TEST(BilletInDie, TwoDimensionsE3) {
  const Overrides fine{"numerics.spacing=0.5 mm", "rigid.0.heat.mesh.near=0.5 mm"};
  const auto errors = [&](const char* name, const std::vector<Moment>& moments, const Overrides& overrides) {
    const double coarse_error = billet_in_die(name, "e3_billet_in_die_2d", moments, overrides);
    const double fine_error = billet_in_die(name, "e3_billet_in_die_2d", moments, joined(overrides, fine));
    std::printf("E3, %s: largest deviation at spacings of 1 and 0.5 mm %.3f and %.3f K, order %.2f\n", name,
                coarse_error, fine_error, order(coarse_error, fine_error));
    EXPECT_LT(fine_error, one_percent);
    EXPECT_GT(order(coarse_error, fine_error), 0.9);  // the staircase of the lattice at the bore is of first order
  };
  errors("2-D, h = 147", weak_film, {});
  errors("2-D, h = 1e4", strong_film, strong);
}

TEST(BilletInDie, TurningDieChangesNothingE3) {
  const double error = billet_in_die(
      "2-D, h = 1e4, die turns with 1.7 m/s at the bore", "e3_billet_in_die_2d", strong_film,
      joined(strong, {"numerics.spacing=0.5 mm", "rigid.0.heat.mesh.near=0.5 mm", "rigid.0.rotation.rate=1.7/0.0125"}));
  EXPECT_LT(error, one_percent);
}

/// E9: heat content of particles and mesh [J] above 300 K, from their temperatures; c_p = 706.7 + 0.6 T - 1e-4 T^2.
struct Enthalpy {
  double particles = 0, mesh = 0;
};

Enthalpy enthalpy(const Simulation& simulation) {
  const auto content = [](double t) {
    const auto integral = [](double u) { return 706.7 * u + 0.3 * u * u - 1e-4 / 3 * u * u * u; };
    return integral(t) - integral(300);
  };
  Enthalpy sum;
  const ParticleSet& particles = simulation.particles();
  for (std::size_t i = 0; i < particles.owned(); ++i)
    sum.particles += particles[field::mass][i] * content(particles[field::temperature][i]);
  sum.particles = simulation.comm().sum(sum.particles);
  const RigidHeat& disc = simulation.rigid_heat()[0];
  for (std::size_t n = 0; n < disc.mesh->nodes(); ++n)
    sum.mesh += disc.mesh->node_mass(n) * content(disc.node_temperature[n]);
  return sum;
}

TEST(Conservation, TurningMeshWithVaryingPropertiesE9) {
  for (const char* scene : {"e9_conservation", "e9_conservation_2d"})
    for (const int iterations : {1, 4}) {
      const auto simulation =
          started(verification_scene(scene), {"heat.nonlinear_iterations=" + std::to_string(iterations)});
      const Enthalpy before = enthalpy(*simulation);
      run_to_end(*simulation);
      const Enthalpy after = enthalpy(*simulation);
      const double total = before.particles + before.mesh;
      const double lost = before.particles - after.particles, gained = after.mesh - before.mesh;
      const double interface = history_value(*simulation, "disc.interface_heat");
      std::printf(
          "E9, %s, %d solves: %.4g of %.4g J exchanged; lost + gained %.1e, interface less gained %.1e of all\n", scene,
          iterations, interface, total, (gained - lost) / total, (interface - gained) / total);
      EXPECT_GT(std::abs(interface), 1e-3 * total);
      // Rounding only: what one side loses the other gains, at any tolerance of the solver (1e-6 here). Ten times that
      // tolerance is what the catalogue asks.
      EXPECT_NEAR(gained, lost, 1e-11 * total);
      EXPECT_NEAR(interface, gained, 1e-11 * total);
      EXPECT_NEAR(history_value(*simulation, "heat.particles"), -lost, 1e-11 * total);
      EXPECT_NEAR(history_value(*simulation, "heat.rigid"), gained, 1e-11 * total);
    }
}

/// D5: rise of both faces of half spaces of AL and ST that rub with a stress of 31.2 MPa at 1 m/s: 2 q
/// sqrt(t/pi)/(e1+e2).
double rise_by_friction(double t) {
  return 2 * 31.2e6 * std::sqrt(t / pi) / (std::sqrt(2785.0 * 875 * 188) + std::sqrt(7800.0 * 460 * 24.4));
}

TEST(FrictionPartition, ExactSolutionOfTheCatalogue) {
  EXPECT_NEAR(rise_by_friction(1e-3), 36.19, 0.005);
  EXPECT_NEAR(rise_by_friction(10e-3), 114.45, 0.005);
}

TEST_P(InBothSpaces, BothFacesWarmAlikeD5) {
  const int dim = GetParam();
  const double half = 0.24e-3;
  Overrides all = touching_columns(-2.4e-3, 0.8e-3, half, dim);
  if (dim == 2) all.push_back("body.0.lattice_origin=[\"0.004 mm\", \"0 mm\"]");
  const auto simulation = started(verification_scene("d5_heat_partition"), all);
  run_to_end(*simulation);
  const double hot = face_temperature(*simulation, 0) - 300, steel = mesh_face_temperature(*simulation, 0, 0) - 300;
  const double exact = rise_by_friction(simulation->clock().time);
  const double work = simulation->comm().sum(simulation->contact()->ledger().friction);
  const double expected_work = 31.2e6 * std::pow(2 * half, dim - 1) * simulation->clock().time;
  const double particles = history_value(*simulation, "heat.particles"),
               rigid = history_value(*simulation, "heat.rigid");
  std::printf(
      "D5, %d-D: rise of the aluminium %.2f K (%+.2f %%), of the steel %.2f K (%+.2f %%), exact %.2f; friction work "
      "%+.3f %%, heat in both over work - 1: %.1e\n",
      dim, hot, 100 * (hot / exact - 1), steel, 100 * (steel / exact - 1), exact, 100 * (work / expected_work - 1),
      (particles + rigid) / work - 1);
  EXPECT_NEAR(hot, exact, 0.03 * exact);
  EXPECT_NEAR(steel, exact, 0.03 * exact);
  EXPECT_NEAR(work, expected_work, 1e-3 * expected_work);
  EXPECT_NEAR(particles + rigid, work, 1e-10 * work);
}

}  // namespace
}  // namespace stirsph::testing
