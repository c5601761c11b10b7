/// The hourglass control against plain double sums, and what it must leave alone.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "neighbours/smoothing_kernel.hpp"
#include "support/scene_run.hpp"

namespace stirsph::testing {
namespace {

const std::string materials = std::string(STIRSPH_SOURCE_DIR) + "/tests/verification/materials";

const char* const block = R"toml(
[numerics]
spacing = "1 mm"
gradient_correction = "full"
hourglass_control = 1.5
viscosity_alpha = 0
[time]
end = "1 s"
[[material]]
name = "AL"
file = "al_elastic.toml"
[[body]]
name = "block"
material = "AL"
shape = { type = "box", low = ["0 mm", "0 mm", "-4 mm"], high = ["9 mm", "9 mm", "5 mm"] }
)toml";

std::unique_ptr<Simulation> started_block(const std::vector<std::string>& overrides) {
  auto simulation = std::make_unique<Simulation>(Comm(), read_scene_text(block, materials, overrides));
  simulation->start();
  return simulation;
}

/// The first sweep and the control over a step of dt, with the velocities the particles have.
void load_springs(Simulation& run, double dt) {
  const HaloExchange& halo = run.neighbourhood().halo();
  halo.exchange(run.particles(), Halo::Kinematic);
  run.mechanics()->update_stress(run.particles(), run.neighbourhood().pairs(), dt);
  halo.exchange(run.particles(), Halo::Gradient);
  run.mechanics()->update_hourglass(run.particles(), run.neighbourhood().pairs(), dt);
}

double noise(std::size_t k) { return std::fmod(std::sin(12.9898 * static_cast<double>(k + 1)) * 43758.5453, 1.0); }

class HourglassIn : public ::testing::TestWithParam<std::string> {};

TEST_P(HourglassIn, ForceAndStressAreThePlainDoubleSums) {
  const auto run = started_block({"space=" + GetParam(), "body.0.jitter=0.1"});
  ParticleSet& particles = run->particles();
  const int dim = particles.layout().dim;
  for (std::size_t i = 0; i < particles.owned(); ++i)
    for (int d = 0; d < dim; ++d)
      particles.component(field::velocity, d)[i] =
          noise(3 * static_cast<std::size_t>(particles[field::id][i]) + static_cast<std::size_t>(d));
  const double dt = 1e-9, h = 1.3e-3, zeta = 1.5, shear = run->mechanics()->materials()[0].shear_modulus();
  load_springs(*run, dt);

  std::vector<std::vector<double>> x, v, gradient;
  for (int d = 0; d < dim; ++d) {
    x.push_back(gathered(*run, field::position, d));
    v.push_back(gathered(*run, field::velocity, d));
  }
  for (int c = 0; c < dim * dim; ++c) gradient.push_back(gathered(*run, field::velocity_gradient, c));
  std::vector<double> volume = gathered(*run, field::mass);  // at the start
  for (double& value : volume) value /= run->mechanics()->materials()[0].density;
  double largest_force = 0, worst_force = 0, largest_stress = 0, worst_stress = 0, resultant = 0;
  for (std::size_t i = 0; i < particles.owned(); ++i) {
    const auto id = static_cast<std::size_t>(particles[field::id][i]);
    std::vector<double> force(dim, 0.0), moment(dim * dim, 0.0);
    for (std::size_t j = 0; j < volume.size(); ++j) {
      if (j == id) continue;
      std::vector<double> apart(dim);
      double r2 = 0;
      for (int d = 0; d < dim; ++d) {
        apart[d] = x[d][j] - x[d][id];
        r2 += apart[d] * apart[d];
      }
      const double r = std::sqrt(r2);
      if (r >= 2 * h) continue;
      const double slope = CubicSpline::normalisation(dim) / std::pow(h, dim + 1) * CubicSpline::slope(r / h);
      for (int a = 0; a < dim; ++a) {
        double unseen = v[a][j] - v[a][id];
        for (int b = 0; b < dim; ++b) unseen -= 0.5 * (gradient[a * dim + b][id] + gradient[a * dim + b][j]) * apart[b];
        const double spring = -2 * zeta * shear * volume[id] * volume[j] * slope / r * unseen * dt;
        force[a] += spring;
        for (int b = 0; b < dim; ++b) moment[a * dim + b] -= spring * apart[b] / (2 * particles[field::volume][i]);
      }
    }
    for (int a = 0; a < dim; ++a) {
      const double own = particles.component(field::hourglass_force, a)[i];
      worst_force = std::max(worst_force, std::abs(own - force[a]));
      largest_force = std::max(largest_force, std::abs(force[a]));
      resultant += a == 0 ? own : 0.0;
      for (int b = 0; b < dim; ++b) {
        const double stress = particles.component(field::hourglass_stress, a * dim + b)[i];
        worst_stress = std::max(worst_stress, std::abs(stress - moment[a * dim + b]));
        largest_stress = std::max(largest_stress, std::abs(moment[a * dim + b]));
      }
    }
  }
  const Comm& comm = run->comm();
  largest_force = comm.max(largest_force);
  EXPECT_LT(comm.max(worst_force), 1e-12 * largest_force);
  EXPECT_LT(comm.max(worst_stress), 1e-12 * comm.max(largest_stress));
  EXPECT_LT(std::abs(comm.sum(resultant)), 1e-11 * largest_force) << "springs push both ends alike";
}

INSTANTIATE_TEST_SUITE_P(Spaces, HourglassIn, ::testing::Values("cartesian3", "plane_strain"));

/// A uniform velocity gradient loads nothing, at faces, edges and corners neither; one that varies linearly nothing
/// inside, where the gradient of a lattice is exact.
TEST(Hourglass, LeavesSmoothMotionAlone) {
  for (const bool quadratic : {false, true}) {
    const auto run = started_block({});
    ParticleSet& particles = run->particles();
    for (std::size_t i = 0; i < particles.owned(); ++i) {
      const Vec3 x = particles.vector_at(field::position, i);
      const double bend = quadratic ? 100 * x.x * x.y : 0.0;
      particles.component(field::velocity, 0)[i] = 3 * x.y - x.z + bend;
      particles.component(field::velocity, 1)[i] = 2 * x.x + x.y;
      particles.component(field::velocity, 2)[i] = -x.z;
    }
    load_springs(*run, 1e-9);
    double largest = 0;
    for (std::size_t i = 0; i < particles.owned(); ++i) {
      const Vec3 x = particles.vector_at(field::position, i);
      const double wall = std::min({x.x, x.y, x.z + 4e-3, 9e-3 - x.x, 9e-3 - x.y, 5e-3 - x.z});
      if (quadratic && wall < 4e-3) continue;  // its neighbours' gradients must be exact too
      for (int d = 0; d < 3; ++d)
        largest = std::max(largest, std::abs(particles.component(field::hourglass_force, d)[i]));
    }
    // What a single particle that moves by the velocity differences of a spacing would feel.
    const double single = 27e9 * 1e-3 * 3e-3 * 1e-9;
    EXPECT_LT(run->comm().max(largest), 1e-9 * single) << (quadratic ? "quadratic" : "linear");
  }
}

/// The viscosity of the velocity without its swirl sees the strain rate of that velocity: a swirl that varies along the
/// axis is no part of it. Inside, where the gradient of a lattice is exact for the products of two coordinates.
TEST(ReconstructedViscosity, KnowsTheStrainRateWithoutTheSwirl) {
  const auto run = started_block(
      {"numerics.viscosity_alpha=1", "numerics.viscosity_velocity=no_swirl", "numerics.viscosity_reconstruction=true",
       "body.0.shape.low=[\"-4.5 mm\",\"-4.5 mm\",\"-4 mm\"]", "body.0.shape.high=[\"4.5 mm\",\"4.5 mm\",\"5 mm\"]"});
  ParticleSet& particles = run->particles();
  for (std::size_t i = 0; i < particles.owned(); ++i) {
    const Vec3 x = particles.vector_at(field::position, i);
    const double spin = 1000 + 2e5 * x.z;
    particles.component(field::velocity, 0)[i] = -20 * x.x - spin * x.y;
    particles.component(field::velocity, 1)[i] = -20 * x.y + spin * x.x;
    particles.component(field::velocity, 2)[i] = -30 * x.z;
  }
  load_springs(*run, 1e-12);
  const std::array<double, 6> exact{-20, -20, -30, 0, 0, 0};
  double worst = 0, looked_at = 0;
  for (std::size_t i = 0; i < particles.owned(); ++i) {
    const Vec3 x = particles.vector_at(field::position, i);
    if (std::max({std::abs(x.x), std::abs(x.y), std::abs(x.z - 0.5e-3)}) > 1.6e-3) continue;
    for (int c = 0; c < 6; ++c)
      worst =
          std::max(worst, std::abs(particles.component(field::strain_rate, c)[i] - exact[static_cast<std::size_t>(c)]));
    ++looked_at;
  }
  EXPECT_GT(run->comm().sum(looked_at), 20);
  EXPECT_LT(run->comm().max(worst), 1e-9 * 300) << "300/s is what the swirl shears";
}

TEST(Hourglass, NeedsTheFullCorrection) {
  try {
    read_scene_text(block, materials, {"numerics.gradient_correction=velocity"});
    FAIL() << "it should have been refused";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("Give gradient_correction = \"full\""), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace stirsph::testing
