/// Swirl around the axis: linear fields of the axisymmetric space, F2 of the verification catalogue, and spins without
/// inertia in both spaces.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "support/scene_run.hpp"

namespace stirsph::testing {
namespace {

const std::string plug = verification_scene("f2_spinning_plug");

/// Mean normal pressure [Pa] of the particles on the first rigid body.
double wall_pressure(const Simulation& simulation) {
  const ContactLoad& load = simulation.contact()->loads()[0];
  return simulation.comm().sum(load.normal_force) / simulation.comm().sum(load.area);
}

TEST(Rings, LinearFieldsAreExactAlsoAtTheAxis) {
  constexpr double a = 300, b = -100, twist = 5e4, dt = 1e-9;  // 1/s, 1/s, 1/(m s), s
  const auto simulation =
      started(plug, {"numerics.gradient_correction=velocity", "numerics.inertia=no_swirl", "numerics.viscosity_alpha=0",
                     "time.step=1e-9 s", "body.0.rotation.rate=0 rpm", "body.0.velocity.x=300*x",
                     "body.0.velocity.y=5e4*x*z", "body.0.velocity.z=-100*z", "contact=[]"});
  simulation->step();
  const double shear = simulation->mechanics()->materials()[0].shear_modulus();
  const auto strain = gathered(*simulation, field::volumetric_strain);
  const auto hoop = gathered(*simulation, field::stress_deviator, 1), torsion = gathered(*simulation, field::stress, 5),
             across = gathered(*simulation, field::stress, 3), r = gathered(*simulation, field::position, 0);
  for (std::size_t i = 0; i < strain.size(); ++i) {
    EXPECT_NEAR(strain[i], (2 * a + b) * dt, 1e-5 * a * dt) << "r = " << r[i];
    EXPECT_NEAR(hoop[i], 2 * shear * dt * (a - (2 * a + b) / 3), 1e-5 * shear * dt * a) << "r = " << r[i];
    EXPECT_NEAR(torsion[i], shear * twist * r[i] * dt, 1e-5 * shear * twist * 0.011 * dt) << "r = " << r[i];
    EXPECT_NEAR(across[i], 0, 1e-5 * shear * twist * 0.011 * dt) << "r = " << r[i];
  }
}

/// Innermost rings feel the torques of their neighbours over a small radius: they must not need smaller steps.
TEST(Rings, LightSwirlIsStableAtTheDefaultStep) {
  const auto simulation =
      started(plug, {"numerics.inertia=no_swirl", "numerics.swirl_density_ratio=0.1", "numerics.viscosity_alpha=0",
                     "time.cfl=0.8", "time.most_steps=2000", "body.0.rotation.rate=0 rpm",
                     "body.0.velocity.y=1e-3*sin(4e3*x)*sin(5e3*z)", "contact=[]"});
  run_to_end(*simulation);
  const Diagnostics end = diagnose(*simulation);
  EXPECT_LT(std::abs(end.energy.residual()), 0.1);  // swings with the square of the step, does not grow
  EXPECT_EQ(end.energy.plastic, 0);
}

TEST(SpinningPlug, ScaledInertiaPressesOnTheWall) {
  const auto simulation = started(plug);
  run_to_end(*simulation);
  const double density = simulation->scene().materials[0].density, rate = 500 * M_PI, radius = 0.011;
  const double exact = 100 * density * rate * rate * radius * radius / 4;
  RecordProperty("over_exact", std::to_string(wall_pressure(*simulation) / exact));
  EXPECT_NEAR(wall_pressure(*simulation), exact, 0.06 * exact);  // 22 rings over the radius: +4 %
  EXPECT_LT(std::abs(diagnose(*simulation).energy.residual()), 1e-5);
}

TEST(SpinningPlug, SwirlWithoutInertiaDoesNot) {
  const auto simulation = started(plug, {"numerics.inertia=no_swirl", "time.end=0.2 ms"});
  run_to_end(*simulation);
  EXPECT_LT(simulation->comm().sum(simulation->contact()->loads()[0].normal_force), 0.01);  // N, of 14 kN
}

TEST(SpinningPlug, NeitherInThreeDimensions) {
  // The plain gradient is not exact at surfaces and would see a spin as strain there.
  const std::vector<std::string> solid{"space=cartesian3", "numerics.gradient_correction=velocity",
                                       "numerics.spacing=2 mm", "time.end=4 ms", "contact=[]"};  // one turn
  auto without = solid;
  without.push_back("numerics.inertia=no_swirl");
  const auto simulation = started(plug, without);
  run_to_end(*simulation);
  const auto strain = gathered(*simulation, field::volumetric_strain);
  const double dilated = std::abs(*std::ranges::max_element(strain, {}, [](double e) { return std::abs(e); }));
  EXPECT_LT(dilated, 1e-9);
  const auto x = gathered(*simulation, field::position, 0), y = gathered(*simulation, field::position, 1);
  const auto start = started(plug, solid);
  const auto x0 = gathered(*start, field::position, 0), y0 = gathered(*start, field::position, 1);
  for (std::size_t i = 0; i < x.size(); ++i) {  // back where it was
    EXPECT_NEAR(x[i], x0[i], 1e-8);
    EXPECT_NEAR(y[i], y0[i], 1e-8);
  }
}

/// A plug without a die: the mean of its stress across the axis balances the centrifugal force, whatever its outline,
/// and on the axis it is (3 - 2 nu)/(8 (1 - nu)) s rho w^2 R^2 (Love). With a die the same force presses on the wall.
TEST(SpinningPlug, ScaledInertiaTearsAtItInThreeDimensions) {
  const auto simulation = started(
      plug, {"space=cartesian3", "numerics.gradient_correction=full", "numerics.spacing=1 mm", "contact=[]",
             "domain={periodic=[\"z\"], low=[\"-20 mm\", \"-20 mm\", \"0 mm\"], high=[\"20 mm\", \"20 mm\", \"4 mm\"]}",
             "body.0.shape.height=4 mm"});
  run_to_end(*simulation);
  const auto x = gathered(*simulation, field::position, 0), y = gathered(*simulation, field::position, 1),
             volume = gathered(*simulation, field::volume), xx = gathered(*simulation, field::stress, 0),
             yy = gathered(*simulation, field::stress, 1);
  const Material& metal = simulation->scene().materials[0];
  const double rate = 500 * M_PI, weight = 100 * metal.density * rate * rate;
  double stress = 0, centrifugal = 0, axis = 0, whole = 0;
  long near_axis = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    stress += volume[i] * (xx[i] + yy[i]);
    centrifugal += volume[i] * weight * (x[i] * x[i] + y[i] * y[i]);
    whole += volume[i];
    if (std::hypot(x[i], y[i]) > 1.5e-3) continue;
    axis += 0.5 * (xx[i] + yy[i]);
    near_axis += 1;
  }
  const double nu = metal.poisson_ratio, radius_squared = whole / (M_PI * 4e-3);
  const double exact = (3 - 2 * nu) / (8 * (1 - nu)) * weight * radius_squared;
  std::printf("spinning plug, 3-D: mean %.4f, axis %.4f of exact\n", stress / centrifugal,
              axis / static_cast<double>(near_axis) / exact);
  EXPECT_NEAR(stress, centrifugal, 0.03 * centrifugal);
  EXPECT_NEAR(axis / static_cast<double>(near_axis), exact, 0.05 * exact);
}

}  // namespace
}  // namespace stirsph::testing
