/// Planes of symmetry: a part of a symmetric scene between its planes is that part of the whole scene.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <string>
#include <vector>

#include "support/scene_run.hpp"

namespace stirsph::testing {
namespace {

using Overrides = std::vector<std::string>;
using Place = std::array<long, 3>;  // of the start, in tenths of a spacing

struct Outcome {
  std::map<Place, std::vector<double>> particles;  // position, velocity, stress, temperature
  double lid_force = 0;
  Diagnostics end;
};

/// Runs the block and keeps what every particle ends with under the place where it started.
Outcome outcome_of(const Overrides& overrides) {
  const auto simulation = started(verification_scene("symmetric_block"), overrides);
  const SpaceLayout layout = layout_of(simulation->scene().space);
  std::vector<std::vector<double>> start;
  for (int d = 0; d < layout.dim; ++d) start.push_back(gathered(*simulation, field::position, d));
  run_to_end(*simulation);
  std::vector<std::vector<double>> values;
  for (int d = 0; d < layout.dim; ++d) values.push_back(gathered(*simulation, field::position, d));
  for (int c = 0; c < layout.velocity_components; ++c) values.push_back(gathered(*simulation, field::velocity, c));
  for (int c = 0; c < layout.stress_components; ++c) values.push_back(gathered(*simulation, field::stress, c));
  values.push_back(gathered(*simulation, field::temperature));
  Outcome outcome;
  for (std::size_t i = 0; i < start[0].size(); ++i) {
    Place place{};
    for (int d = 0; d < layout.dim; ++d) place[d] = std::lround(start[d][i] / 0.05e-3);
    for (const auto& value : values) outcome.particles[place].push_back(value[i]);
  }
  const Vec3 push = simulation->contact()->loads()[0].force;
  outcome.lid_force = simulation->comm().sum(layout.dim == 2 && !layout.axisymmetric() ? push.y : push.z);
  outcome.end = diagnose(*simulation);
  return outcome;
}

/// `share`: the part's share of the force on the lid.
void expect_part_of_the_whole(const Overrides& space, const Overrides& planes, double share) {
  Overrides cut = space;
  cut.insert(cut.end(), planes.begin(), planes.end());
  const Outcome whole = outcome_of(space), part = outcome_of(cut);
  ASSERT_FALSE(part.particles.empty());
  EXPECT_EQ(whole.particles.size() % part.particles.size(), 0u);
  std::vector<double> largest, worst;
  for (const auto& [place, values] : whole.particles) {
    largest.resize(values.size());
    for (std::size_t k = 0; k < values.size(); ++k) largest[k] = std::max(largest[k], std::abs(values[k]));
  }
  worst.resize(largest.size());
  for (const auto& [place, values] : part.particles) {
    const auto same = whole.particles.find(place);
    ASSERT_NE(same, whole.particles.end());
    for (std::size_t k = 0; k < values.size(); ++k)
      if (largest[k] > 0) worst[k] = std::max(worst[k], std::abs(values[k] - same->second[k]) / largest[k]);
  }
  const double most = *std::max_element(worst.begin(), worst.end());
  std::printf("%s, %s: %zu of %zu particles, largest difference %.2g, energy residual %.2g\n", space[0].c_str(),
              planes[0].c_str(), part.particles.size(), whole.particles.size(), most, part.end.energy.residual());
  EXPECT_LT(most, 1e-9);
  EXPECT_NEAR(part.lid_force / whole.lid_force, share, 1e-9);
  EXPECT_GT(std::abs(whole.lid_force), 1);
  EXPECT_GT(whole.end.plastic_strain_max, 0.01);
  EXPECT_LT(std::abs(part.end.energy.residual()), 1e-2);
}

TEST(PlanesOfSymmetry, QuarterAndEighthInThreeDimensions) {
  expect_part_of_the_whole({"space=cartesian3"}, {"domain.symmetry.x=0 mm", "domain.symmetry.y=0 mm"}, 0.25);
  expect_part_of_the_whole({"space=cartesian3"},
                           {"domain.symmetry.x=0 mm", "domain.symmetry.y=0 mm", "domain.symmetry.z=0 mm"}, 0.25);
}

TEST(PlanesOfSymmetry, WithHourglassControl) {
  const Overrides control{"space=cartesian3", "numerics.artificial_stress=0", "numerics.hourglass_control=1"};
  expect_part_of_the_whole(control, {"domain.symmetry.x=0 mm", "domain.symmetry.y=0 mm"}, 0.25);
}

TEST(PlanesOfSymmetry, QuarterInPlaneStrain) {
  const Overrides flat{"space=plane_strain",
                       "body.0.shape.low=[\"-3 mm\", \"-3 mm\"]",
                       "body.0.shape.high=[\"3 mm\", \"3 mm\"]",
                       "body.0.velocity={x = \"60*sin(600*x)\", y = \"-70*sin(500*y)\"}",
                       "rigid.0.shape={type = \"half_space\", point = [\"0 mm\", \"3 mm\"], normal = [0, -1]}",
                       "rigid.0.motion={type = \"velocity\", y = \"-90 m/s\"}",
                       "rigid.1.shape={type = \"half_space\", point = [\"0 mm\", \"-3 mm\"], normal = [0, 1]}",
                       "rigid.1.motion={type = \"velocity\", y = \"90 m/s\"}"};
  expect_part_of_the_whole(flat, {"domain.symmetry.x=0 mm", "domain.symmetry.y=0 mm"}, 0.5);
}

TEST(PlanesOfSymmetry, HalfOfARoundBlock) {
  const Overrides round{"space=axisymmetric",
                        "body.0.shape={type = \"cylinder\", base = [\"0 mm\", \"0 mm\", \"-3 mm\"], radius = \"3 mm\", "
                        "height = \"6 mm\"}",
                        "body.0.velocity={x = \"60*sin(600*x)\", y = \"3e3*x\", z = \"-70*sin(500*z) + 2e6*z*x^2\"}"};
  expect_part_of_the_whole(round, {"domain.symmetry.z=0 mm"}, 1);
}

TEST(PlanesOfSymmetry, WhatTurnsAcrossThemIsRefused) {
  try {
    read_scene(verification_scene("symmetric_block"), {"domain.symmetry.x=0 mm", "rigid.0.rotation.rate=100 rpm"});
    FAIL() << "it should have been refused";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("turns across the plane of symmetry domain.symmetry.x"), std::string::npos)
        << error.what();
  }
}

}  // namespace
}  // namespace stirsph::testing
