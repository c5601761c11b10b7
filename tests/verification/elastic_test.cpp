/// B1 and B2 of the verification catalogue: elastic waves, as ordinary scenes.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "support/scene_run.hpp"

namespace stirsph::testing {
namespace {

/// Overrides that make the box `n` spacings long, one wave in it.
std::vector<std::string> wave_of(int n, const std::string& kernel, double h_over_dx, const std::string& correction) {
  const std::string length = std::to_string(n) + " mm";
  return {"numerics.kernel=" + kernel,
          "numerics.h_over_dx=" + std::to_string(h_over_dx),
          "numerics.gradient_correction=" + correction,
          "domain.high=[\"" + length + "\", \"4 mm\", \"4 mm\"]",
          "body.0.shape.high=[\"" + length + "\", \"4 mm\", \"4 mm\"]",
          "body.0.velocity.x=1e-3*sin(2*pi*x/" + std::to_string(1e-3 * n) + ")"};
}

/// Frequency of the standing wave over that of the continuum: the first zero of its amplitude is a quarter period.
double relative_phase_speed(int n, const std::string& kernel, double h_over_dx, const std::string& correction) {
  const auto simulation = started(verification_scene("b1_plane_wave"), wave_of(n, kernel, h_over_dx, correction));
  const double length = 1e-3 * n, k = 2 * std::numbers::pi / length;
  const double c = simulation->mechanics()->wave_speed();
  double before_time = 0, before = 0;
  const auto amplitude = [&] {
    double sum = 0;
    const ParticleSet& particles = simulation->particles();
    for (std::size_t i = 0; i < particles.owned(); ++i)
      sum += particles.component(field::velocity, 0)[i] * std::sin(k * particles.component(field::position, 0)[i]);
    return simulation->comm().sum(sum);
  };
  before = amplitude();
  for (;;) {
    simulation->step();
    const double now = amplitude(), time = simulation->clock().time;
    if (now <= 0) {
      const double zero = before_time + (time - before_time) * before / (before - now);
      return 0.5 * std::numbers::pi / zero / (k * c);
    }
    before = now;
    before_time = time;
  }
}

struct WaveCase {
  const char* kernel;
  double h_over_dx;
  int n;
  double reference;  ///< verification.md B1, uncorrected
};

class PlaneWave : public ::testing::TestWithParam<WaveCase> {};

TEST_P(PlaneWave, HasTheSemiDiscretePhaseSpeed) {
  const WaveCase& c = GetParam();
  const double speed = relative_phase_speed(c.n, c.kernel, c.h_over_dx, "none");
  // 1e-3 as the catalogue asks; the step (cfl 0.05) adds about 1e-4.
  EXPECT_NEAR(speed, c.reference, 1e-3 * c.reference) << c.kernel << " " << c.n;
}

INSTANTIATE_TEST_SUITE_P(B1, PlaneWave,
                         ::testing::Values(WaveCase{"cubic", 1.3, 4, 0.51813}, WaveCase{"cubic", 1.3, 8, 0.84709},
                                           WaveCase{"cubic", 1.3, 20, 0.96858},
                                           WaveCase{"wendland_c2", 1.5, 8, 0.82628},
                                           WaveCase{"wendland_c2", 2.0, 8, 0.71482},
                                           WaveCase{"quintic", 1.0, 8, 0.86595}));

TEST(PlaneWaveCorrected, FollowsFromTheFirstMoment) {
  // Table: 0.85264 when both sums are divided by Mxx = 1 - 6.5163e-3; the velocity gradient alone gives the geometric
  // mean.
  EXPECT_NEAR(relative_phase_speed(8, "cubic", 1.3, "full"), 0.85264, 1e-3 * 0.85264);
  EXPECT_NEAR(relative_phase_speed(8, "cubic", 1.3, "velocity"), 0.84709 / std::sqrt(1 - 6.5163e-3), 1e-3);
}

TEST(BarOnWall, ReboundsAsTheWaveSaysB2) {
  const auto simulation = started(verification_scene("b2_bar_on_wall"));
  const double contact_time = 7.845e-6, stress = 141.998e6, area = 2.4e-3 * 2.4e-3;  // exact: 2L/c, rho c v
  double plateau = 0, plateau_time = 0, first = 0, last = 0;
  double before = 0;
  run_to_end(*simulation, [&] {
    const double t = simulation->clock().time, dt = t - before, now = -simulation->rigid_force(0).x / area;
    before = t;
    if (t > 0.1 * contact_time && t < 0.9 * contact_time) {
      plateau += now * dt;
      plateau_time += dt;
    }
    if (now > 0.5 * stress) {
      if (first == 0) first = t;
      last = t;
    }
  });
  const Diagnostics end = diagnose(*simulation);
  std::printf("B2: plateau %.3f MPa, contact time %.4f us, rebound %.4f m/s, viscous loss %.4f, residual %.2g\n",
              plateau / plateau_time / 1e6, (last - first) * 1e6, end.probes[0],
              end.energy.viscous / end.energy.initial_kinetic, end.energy.residual());
  EXPECT_NEAR(plateau / plateau_time, stress, 0.02 * stress);        // measured 0.1 %
  EXPECT_NEAR(last - first, contact_time, 0.03 * contact_time);      // measured 1.5 %
  EXPECT_NEAR(end.probes[0], 10.0, 0.3);                             // measured 2.5 %
  EXPECT_LT(end.energy.viscous / end.energy.initial_kinetic, 0.03);  // measured 1.5 %
  EXPECT_LT(std::abs(end.energy.residual()), 2e-3);                  // measured 5e-4
  EXPECT_EQ(end.plastic_strain_max, 0.0);
}

}  // namespace
}  // namespace stirsph::testing
