/// Heat in the axisymmetric space as ordinary scenes: against exact solutions of round bodies, the billet in its die
/// (E3), conservation (E9), and the same scene in three dimensions.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "io/rigid_snapshot.hpp"
#include "support/heat_scene_run.hpp"

namespace stirsph::testing {
namespace {

constexpr double pi = std::numbers::pi;
constexpr double diffusivity = 188.0 / (2785 * 875);  // m2/s of AL

double bessel(int order, double x) { return std::cyl_bessel_j(order, x); }

/// Temperature of a rod of radius 1 that starts at 0 with its surface at 1; `t` is the Fourier number.
double quenched_rod(double r, double t) {
  double sum = 0;
  for (int n = 1; n <= 60; ++n) {
    double root = (n - 0.25) * pi;
    for (int k = 0; k < 20; ++k) root += bessel(0, root) / bessel(1, root);
    sum += 2 / (root * bessel(1, root)) * bessel(0, root * r) * std::exp(-root * root * t);
  }
  return 1 - sum;
}

TEST(QuenchedRod, SeriesOfTheTextbooks) {
  EXPECT_NEAR(quenched_rod(1, 0.01), 1, 1e-12);
  EXPECT_NEAR(quenched_rod(0, 1e-3), 0, 1e-6);
  EXPECT_NEAR(quenched_rod(0, 0.2), 1 - 0.5015, 1e-3);  // Carslaw and Jaeger's chart
}

/// A slice of the rod of 10 mm with `count` rings across.
Overrides slice(int count) {
  const double spacing = 0.01 / count, half = 3 * spacing;
  char text[600];
  std::snprintf(text, sizeof text, "\"0 m\", \"0 m\", \"%.15g m\"", -half);
  const std::string base = text;
  return {override_of("numerics.spacing", spacing, "m"), corner("domain.low", {-0.02, -0.02, -half}, 3),
          corner("domain.high", {0.02, 0.02, half}, 3), "body.0.shape.base=[" + base + "]",
          override_of("body.0.shape.height", 2 * half, "m")};
}

TEST(QuenchedRod, Particles) {
  std::array<double, 3> errors{};
  const double t = 0.4;
  for (int k = 0; k < 3; ++k) {
    const int count = 10 << k;
    const auto simulation = started(verification_scene("round_slice"), slice(count));
    ASSERT_EQ(simulation->particle_count(), 6 * count);
    run_until(*simulation, t);
    // Weighted with the volume of the rings, as an error over the body.
    const std::vector<double> r = gathered(*simulation, field::position, 0),
                              temperature = gathered(*simulation, field::temperature);
    double error = 0, scale = 0;
    for (std::size_t i = 0; i < r.size(); ++i) {
      const double exact = quenched_rod(r[i] / 0.01, diffusivity * t / 1e-4);
      error += r[i] * std::pow((temperature[i] - 300) / 100 - exact, 2);
      scale += r[i] * exact * exact;
    }
    errors[k] = std::sqrt(error / scale);
    std::printf("quenched rod, %d rings: error %.2e%s\n", count, errors[k],
                k > 0 ? (", order " + std::to_string(order(errors[k - 1], errors[k]))).c_str() : "");
  }
  EXPECT_LT(errors[1], 0.01);
  EXPECT_GT(order(errors[0], errors[1]), 1.6);
  EXPECT_GT(order(errors[1], errors[2]), 1.6);
}

const Overrides steady{"time.step=100 s", "time.end=2000 s", "heat.scheme=backward_euler"};

/// 400 K at 5 mm, 300 K at 10 mm: T is linear in ln r, and the heat flow 2 pi k H dT/ln 2.
TEST(SteadyTube, Particles) {
  const double core = 400, shell = 300;
  std::array<double, 2> errors{}, flows{};
  for (int k = 0; k < 2; ++k) {
    const int count = 20 << k;
    const double height = 6 * 0.01 / count;
    const auto simulation = started(verification_scene("round_tube"), joined(slice(count), steady));
    run_to_end(*simulation);
    const std::vector<double> r = gathered(*simulation, field::position, 0),
                              temperature = gathered(*simulation, field::temperature);
    for (std::size_t i = 0; i < r.size(); ++i) {
      const double exact = shell + (core - shell) * std::log(r[i] / 0.01) / std::log(0.5);
      errors[k] = std::max(errors[k], std::abs(temperature[i] - exact) / (core - shell));
    }
    const double exact_flow = 2 * pi * 188 * height * (core - shell) / std::log(2.0);
    flows[k] = simulation->last_heat().bodies[0].interface / 100 / exact_flow - 1;
    EXPECT_NEAR(simulation->last_heat().bodies[0].interface, -simulation->last_heat().bodies[1].interface,
                1e-6 * exact_flow * 100);
    std::printf("steady tube, %d rings: heat flow %+.3f %%, largest error %.2e\n", count / 2, 100 * flows[k],
                errors[k]);
  }
  EXPECT_LT(std::abs(flows[0]), 0.005);
  EXPECT_GT(order(std::abs(flows[0]), std::abs(flows[1])), 0.9);
  EXPECT_LT(errors[0], 0.01);
  EXPECT_LT(errors[1], errors[0]);
}

/// A meshed ring, 400 K at the bore of 40 mm, a film at the mantle of 60 mm.
TEST(SteadyTube, Mesh) {
  const double resistance = std::log(1.5) / (2 * pi * 188 * 2e-3), film = 1 / (2000 * 2 * pi * 60e-3 * 2e-3);
  const double flow = 100 / (resistance + film);
  std::array<double, 2> errors{};
  for (int k = 0; k < 2; ++k) {
    const std::string size = k == 0 ? "2 mm" : "1 mm";
    const auto simulation =
        started(verification_scene("round_slice"),
                joined(steady, {"rigid.1.heat.mesh.near=" + size, "rigid.1.heat.mesh.far=" + size}));
    run_to_end(*simulation);
    const RigidHeat& body = simulation->rigid_heat()[1];
    double lost = 0;
    for (std::size_t n = 0; n < body.mesh->nodes(); ++n) {
      const double r = body.mesh->mesh().nodes[n].x;
      const double exact = 400 - flow * std::log(r / 40e-3) / (2 * pi * 188 * 2e-3);
      errors[k] = std::max(errors[k], std::abs(body.node_temperature[n] - exact) / 100);
      lost += body.mesh->film_conductance(n) * body.node_temperature[n] - body.mesh->film_source(n);
    }
    std::printf("steady meshed tube, edges of %s: heat flow %+.4f %%, largest error %.2e\n", size.c_str(),
                100 * (lost / flow - 1), errors[k]);
    EXPECT_NEAR(lost / flow, 1, 1e-3);
  }
  EXPECT_LT(errors[1], 1e-4);
  EXPECT_GT(order(errors[0], errors[1]), 1.5);
}

/// E3 from the same file as in three dimensions, with whole rings to the bore.
TEST(BilletInDie, AxisymmetricE3) {
  struct Moment {
    double t, axis, face, thermocouple;
  };
  const auto largest_deviation = [](int count, const std::vector<Moment>& moments, const Overrides& more) {
    const double spacing = 12.5e-3 / count, half = 3 * spacing;
    const std::string base = corner("body.0.shape.base", {0, 0, -half}, 3);
    const auto simulation = started(
        verification_scene("e3_billet_in_die"),
        joined({"space=axisymmetric", "body.0.fill_margin=0.5", override_of("numerics.spacing", spacing, "m"),
                override_of("rigid.0.heat.mesh.near", spacing, "m"), corner("domain.low", {-0.015, -0.015, -half}, 3),
                corner("domain.high", {0.015, 0.015, half}, 3), base, corner("rigid.0.shape.base", {0, 0, -half}, 3),
                override_of("body.0.shape.height", 2 * half, "m"), override_of("rigid.0.shape.height", 2 * half, "m")},
               more));
    double worst = 0;
    for (const Moment& m : moments) {
      run_until(*simulation, m.t);
      const double axis = probe_values(*simulation, "axis")[0], face = mean(probe_values(*simulation, "face")),
                   thermocouple = probe_values(*simulation, "thermocouple")[0];
      std::printf(
          "E3, axisymmetric, %d rings, %g s: axis %.2f (%.2f), die face %.2f (%.2f), thermocouple %.2f (%.2f) K\n",
          count, m.t, axis, m.axis, face, m.face, thermocouple, m.thermocouple);
      worst =
          std::max({worst, std::abs(axis - m.axis), std::abs(face - m.face), std::abs(thermocouple - m.thermocouple)});
    }
    return worst;
  };
  const std::vector<Moment> weak{{1, 670.45, 299.20, 297.25},
                                 {10, 640.09, 308.23, 306.36},
                                 {40, 558.17, 317.57, 316.20},
                                 {100, 455.44, 328.45, 327.72}};
  const Overrides strong_film{"rigid.0.heat.conductance=1e4 W/m2/K", "time.end=1 s", "time.step=10 ms"};
  const std::vector<Moment> strong{{1, 586.80, 445.23, 405.06}};
  for (const int count : {12, 24}) {
    const double a = largest_deviation(count, weak, {}), b = largest_deviation(count, strong, strong_film);
    std::printf("E3, axisymmetric, %d rings: largest deviation %.2f K (h = 147), %.2f K (h = 1e4)\n", count, a, b);
    EXPECT_LT(a, 0.01 * 380);
    EXPECT_LT(b, 0.01 * 380);
  }
}

/// The same scene in both spaces.
TEST(RoundPress, AgreesWithThreeDimensions) {
  const auto run = [](const Overrides& overrides) {
    auto simulation = started(verification_scene("round_press"), overrides);
    run_to_end(*simulation);
    return simulation;
  };
  const auto solid = run({"numerics.spacing=0.667 mm", "rigid.0.heat.mesh.near=1 mm"});
  const auto section = run({"space=axisymmetric", "numerics.spacing=0.5 mm", "body.0.fill_margin=0.5"});
  EXPECT_NEAR(history_value(*section, "mass"), 2785 * pi * 64e-6 * 8e-3, 1e-9);
  const double span = 300;  // K, between billet and surroundings
  for (const char* name : {"centre", "aside", "in_the_cup", "mean", "cup.temperature", "punch.temperature"}) {
    const double a = history_value(*solid, name), b = history_value(*section, name);
    std::printf("billet in a cup, %-18s 3-D %8.3f, axisymmetric %8.3f K\n", name, a, b);
    EXPECT_NEAR(a, b, 0.015 * span) << name;
  }
  for (const char* name : {"heat.particles", "heat.rigid", "heat.source", "heat.fixed", "heat.ambient"}) {
    const double a = history_value(*solid, name), b = history_value(*section, name);
    std::printf("billet in a cup, %-18s 3-D %8.2f, axisymmetric %8.2f J\n", name, a, b);
    EXPECT_NEAR(a, b, 0.04 * std::abs(history_value(*solid, "heat.particles"))) << name;
  }
  EXPECT_NEAR(history_value(*solid, "width"), history_value(*section, "width"), 0.5e-3);
}

/// Two models of one thing: no film at the exact surface, and particles embedded in the mesh.
TEST(RoundPress, HybridInterfaceIsPerfectContact) {
  std::array<double, 2> heat{}, punch{};
  for (int k = 0; k < 2; ++k) {
    const auto simulation = started(
        verification_scene("round_press"),
        {"space=axisymmetric", "numerics.spacing=0.5 mm", "body.0.fill_margin=0.5", "rigid.0.heat.mesh.near=0.5 mm",
         k == 0 ? "rigid.0.heat.interface=perfect" : "rigid.0.heat.interface=hybrid"});
    run_to_end(*simulation);
    heat[k] = history_value(*simulation, "cup.interface_heat");
    punch[k] = history_value(*simulation, "punch.temperature");
  }
  std::printf("billet in a cup: heat through the hybrid interface %+.2f %% of perfect contact\n",
              100 * (heat[1] / heat[0] - 1));
  EXPECT_NEAR(heat[1] / heat[0], 1, 0.03);
  EXPECT_NEAR(punch[1], punch[0], 0.2);
}

TEST(RoundPress, ConservesE9) {
  for (const std::string scheme : {"backward_euler", "crank_nicolson"}) {
    const auto simulation = started(verification_scene("round_press"), {"space=axisymmetric", "heat.scheme=" + scheme});
    const auto content = [&] {
      double sum = 0;
      const ParticleSet& particles = simulation->particles();
      for (std::size_t i = 0; i < particles.owned(); ++i)
        sum += particles[field::mass][i] * 875 * particles[field::temperature][i];
      sum = simulation->comm().sum(sum);
      const RigidHeat &cup = simulation->rigid_heat()[0], &punch = simulation->rigid_heat()[1];
      for (std::size_t n = 0; n < cup.mesh->nodes(); ++n)
        if (!cup.mesh->fixed(n)) sum += cup.mesh->node_mass(n) * 460 * cup.node_temperature[n];
      return sum + punch.heat_capacity * punch.temperature;
    };
    const double before = content();
    run_to_end(*simulation);
    const double gained = content() - before;
    const double given = history_value(*simulation, "heat.source") - history_value(*simulation, "heat.fixed") -
                         history_value(*simulation, "heat.ambient");
    std::printf("E9, axisymmetric, %s: gained less given %.1e of the content\n", scheme.c_str(),
                (gained - given) / before);
    EXPECT_NEAR(gained, given, 1e-10 * before);
    EXPECT_GT(std::abs(gained), 0.01 * before);
    EXPECT_LT(std::abs(history_value(*simulation, "heat.residual")), 1e-10);
  }
}

/// The ranks of this run against one rank alone.
TEST(RoundPress, RanksAgree) {
  const Overrides overrides{"space=axisymmetric", "heat.relative_tolerance=1e-12"};
  const auto together = started(verification_scene("round_press"), overrides),
             alone = started(verification_scene("round_press"), overrides, Comm(MPI_COMM_SELF));
  run_to_end(*together);
  run_to_end(*alone);
  const std::vector<double> a = gathered(*together, field::temperature), b = gathered(*alone, field::temperature);
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) EXPECT_NEAR(a[i], b[i], 1e-7);
  for (std::size_t n = 0; n < together->rigid_heat()[0].mesh->nodes(); ++n)
    EXPECT_NEAR(together->rigid_heat()[0].node_temperature[n], alone->rigid_heat()[0].node_temperature[n], 1e-7);
  EXPECT_NEAR(together->rigid_heat()[1].temperature, alone->rigid_heat()[1].temperature, 1e-8);
}

/// The meshed cup in the snapshot: triangles of the half-plane that do not turn with the body.
TEST(RoundPress, SnapshotOfTheSection) {
  const auto simulation = started(verification_scene("round_press"), {"space=axisymmetric"});
  run_to_end(*simulation);
  ASSERT_GT(std::abs(simulation->rigids()[0].pose.angle), 1);
  const SimplexMesh& mesh = simulation->rigid_heat()[0].mesh->mesh();
  const std::vector<Vec3> points = nodes_in_scene(mesh, simulation->rigids()[0].pose);
  for (std::size_t n = 0; n < points.size(); ++n) {
    EXPECT_EQ(points[n].y, 0);
    EXPECT_GE(points[n].x, 0);
    EXPECT_EQ(norm(points[n] - mesh.nodes[n]), 0);
  }
}

}  // namespace
}  // namespace stirsph::testing
