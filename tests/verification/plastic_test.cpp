/// C1 of the verification catalogue for a block of particles: large simple shear through the whole mechanics.
#include <gtest/gtest.h>

#include <cmath>

#include "support/scene_run.hpp"

namespace stirsph::testing {
namespace {

/// Largest deviation of a stress component from `reference` over particles whose whole support lies inside the block.
double interior_error(const Simulation& simulation, int component, double reference) {
  const ParticleSet& particles = simulation.particles();
  double worst = 0;
  for (std::size_t i = 0; i < particles.owned(); ++i) {
    bool inside = true;
    for (int d = 0; d < 3; ++d)
      inside &= std::abs(particles.component(field::initial_position, d)[i]) < 2e-3;  // support 2.6 mm, half side 5 mm
    if (inside) worst = std::max(worst, std::abs(particles.component(field::stress, component)[i] - reference));
  }
  return simulation.comm().max(worst);
}

TEST(SimpleShearBlock, ElasticJaumannC1) {
  const double g = 27.218045e9;  // shear modulus of AL
  for (const double shear : {0.5, 1.0}) {
    const auto simulation =
        started(verification_scene("c1_shear_block"), {"time.end=" + std::to_string(0.1 * shear) + " ms"});
    run_to_end(*simulation);
    const double tau = interior_error(*simulation, 3, g * std::sin(shear)) / (g * std::sin(shear));
    const double normal = interior_error(*simulation, 0, g * (1 - std::cos(shear))) / (g * (1 - std::cos(shear)));
    std::printf("C1 block, shear %.1f: relative error tau %.2g, sigma_xx %.2g\n", shear, tau, normal);
    EXPECT_LT(tau, 0.01);
    EXPECT_LT(normal, 0.01);
  }
}

/// A block that is turned as a rigid body stays free of stress: the velocity gradient refers to the middle of the step.
TEST(TurnedBlock, HasNoStress) {
  const auto simulation = started(verification_scene("turned_block"));
  double first = 0;
  run_to_end(*simulation, [&] {
    if (simulation->clock().step == 1) first = interior_error(*simulation, 0, 0);
  });
  // The first half kick leads along the tangent, the rest on chords. With the gradient of the end positions each of the
  // 300 steps would add (1e-3)^2/2 to the strain in both directions.
  const double change = std::abs(interior_error(*simulation, 0, 0) - first) / 27.218045e9;
  std::printf("turned block: sigma_xx/G %.2g in the first step, then changes by %.2g\n", first / 27.218045e9, change);
  EXPECT_LT(change, 1e-7);
}

/// The forces take from the motion what the ledger says, also where they are not the adjoint of the gradient that
/// strains the metal: in a bar on its wall half of the plastic work is done within a support's reach of a surface.
TEST(TaylorBar, EnergyClosesWithEveryGradientCorrection) {
  for (const std::string correction : {"none", "velocity", "full"}) {
    const auto simulation = started(verification_scene("c4_taylor_bar"), {"numerics.gradient_correction=" + correction,
                                                                          "numerics.spacing=1 mm", "time.end=40 us"});
    run_to_end(*simulation);
    const EnergyBalance energy = diagnose(*simulation).energy;
    std::printf("Taylor bar, correction %s: energy residual %.2g, plastic %.4g J, unmatched %.2g J\n",
                correction.c_str(), energy.residual(), energy.plastic, energy.unmatched);
    EXPECT_LT(std::abs(energy.residual()), 2e-3) << correction;  // 0.2 of it when plastic work is that of the strain
    EXPECT_GT(energy.plastic, 50);
    EXPECT_LT(std::abs(energy.unmatched), 5e-3 * energy.plastic);
    EXPECT_LT(std::abs(energy.unstored()), 5e-3) << energy.elastic << " J, stored " << energy.stored;
  }
}

/// Metal that is sheared to and fro from step to step, past yield each time, does no work on the mean of old and new
/// stress, but flows all the same. The balance does not tell, as elastic work is what is left over; what is stored
/// does.
TEST(SimpleShearBlock, OscillationFromStepToStepIsTold) {
  for (const bool to_and_fro : {false, true}) {
    const std::string factor = to_and_fro ? "*sin(pi*t/1e-7)" : "";
    const auto simulation = started(verification_scene("c1_shear_block"),
                                    {"material.0.file=../materials/al_perfectly_plastic.toml", "time.step=0.1 us",
                                     "time.end=10 us", "grip.0.velocity.x=2e5*y" + factor});
    run_to_end(*simulation);
    const EnergyBalance energy = diagnose(*simulation).energy;
    std::printf(
        "sheared %s: elastic %.3g J, stored %.3g J, plastic %.3g J, residual %.2g, not stored %.3f of the work\n",
        to_and_fro ? "to and fro" : "on", energy.elastic, energy.stored, energy.plastic, energy.residual(),
        energy.unstored());
    EXPECT_GT(energy.plastic, 1);
    if (to_and_fro)
      EXPECT_LT(energy.elastic - energy.stored, -0.9 * energy.plastic);
    else
      EXPECT_NEAR(energy.unstored(), 0, 5e-3);
  }
}

/// The same in rings: on the axis as well the forces are the adjoint of the gradient, images included. (With the sign
/// of a consistent sum for the images' stress the residual is 7e-3, and innermost rings of a tube extrusion blow up.)
TEST(TaylorBar, EnergyClosesOnTheAxis) {
  const auto simulation = started(verification_scene("c4_taylor_bar"), {"space=axisymmetric", "numerics.spacing=0.4 mm",
                                                                        "probe.0.component=1", "probe.2.component=1"});
  run_to_end(*simulation);
  const Diagnostics end = diagnose(*simulation);
  std::printf("Taylor bar in rings: energy residual %.2g, length %.2f mm, foot %.2f mm\n", end.energy.residual(),
              1e3 * end.probes[0] + 0.2, 1e3 * end.probes[1] + 0.2);
  EXPECT_LT(std::abs(end.energy.residual()), 1e-3);
  EXPECT_GT(end.energy.plastic, 180);
}

/// Plastic work becomes heat: eta of it warms the block.
TEST(SimpleShearBlock, PlasticWorkWarmsIt) {
  const auto simulation =
      started(verification_scene("c1_shear_block"), {"material.0.file=../materials/al.toml", "heat.mode=adiabatic",
                                                     "time.end=20 us", "numerics.gradient_correction=full"});
  const auto enthalpy = [&] {
    double sum = 0;
    const ParticleSet& particles = simulation->particles();
    for (std::size_t i = 0; i < particles.owned(); ++i)
      sum += 875 * particles[field::mass][i] * particles[field::temperature][i];
    return simulation->comm().sum(sum);
  };
  const double before = enthalpy();
  run_to_end(*simulation);
  const Diagnostics end = diagnose(*simulation);
  const double heat = enthalpy() - before;
  std::printf("C1 block, Johnson-Cook: heat over plastic work %.9f, residual %.2g\n", heat / end.energy.plastic,
              end.energy.residual());
  EXPECT_GT(end.energy.plastic, 1);
  EXPECT_NEAR(heat / end.energy.plastic, 0.9, 1e-6);
  EXPECT_LT(std::abs(end.energy.residual()), 1e-2);
}

TEST(SimpleShearBlock, PerfectlyPlasticSaturatesC1) {
  const auto simulation =
      started(verification_scene("c1_shear_block"), {"material.0.file=../materials/harsh_plastic.toml"});
  run_to_end(*simulation);
  // k = 100 MPa, G = 1 GPa: tau = k sqrt(1 - (k/G)^2), sigma_xx = k^2/G.
  const double tau = interior_error(*simulation, 3, 99.4987e6) / 99.4987e6;
  const double normal = interior_error(*simulation, 0, 10.0e6) / 10.0e6;
  std::printf("C1 block, perfectly plastic: relative error tau %.2g, sigma_xx %.2g\n", tau, normal);
  EXPECT_LT(tau, 0.01);
  EXPECT_LT(normal, 0.01);
}

}  // namespace
}  // namespace stirsph::testing
