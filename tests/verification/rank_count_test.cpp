/// G4 of the verification catalogue: 1, 2, 3 and 4 ranks give the same answer. Run on 4 ranks; smaller runs use some of
/// them.
#include <gtest/gtest.h>

#include <cmath>

#include "support/scene_run.hpp"

namespace stirsph::testing {
namespace {

/// A communicator of the first `size` ranks; empty on the others.
class Ranks {
 public:
  explicit Ranks(int size) {
    const Comm world;
    MPI_Comm_split(world.handle(), world.rank() < size ? 0 : MPI_UNDEFINED, world.rank(), &handle_);
  }
  ~Ranks() {
    if (handle_ != MPI_COMM_NULL) MPI_Comm_free(&handle_);
  }
  bool member() const { return handle_ != MPI_COMM_NULL; }
  Comm comm() const { return Comm(handle_); }

 private:
  MPI_Comm handle_ = MPI_COMM_NULL;
};

struct Outcome {
  std::vector<double> position, velocity, stress, temperature;
  std::vector<double> diagnostics;
};

/// The outcome of a scene on `size` ranks, known on all ranks of the test.
Outcome outcome(int size, const std::string& scene, const std::vector<std::string>& overrides) {
  Outcome result;
  const Ranks ranks(size);
  if (ranks.member()) {
    const auto simulation = started(verification_scene(scene), overrides, ranks.comm());
    run_to_end(*simulation);
    for (int d = 0; d < simulation->particles().layout().dim; ++d)
      for (auto [list, info] :
           {std::pair{&result.position, &field::position}, std::pair{&result.velocity, &field::velocity},
            std::pair{&result.stress, &field::stress}}) {
        const auto values = gathered(*simulation, *info, d);
        list->insert(list->end(), values.begin(), values.end());
      }
    result.temperature = gathered(*simulation, field::temperature);
    const Diagnostics d = diagnose(*simulation);
    result.diagnostics = {d.energy.kinetic, d.energy.plastic, d.energy.friction, d.temperature_max};
    for (double probe : d.probes) result.diagnostics.push_back(probe);
    for (std::size_t r = 0; r < simulation->rigids().size(); ++r)
      result.diagnostics.push_back(simulation->rigid_force(static_cast<int>(r)).z);
  }
  const Comm world;
  for (auto* values : {&result.position, &result.velocity, &result.stress, &result.temperature, &result.diagnostics})
    world.broadcast(*values);
  return result;
}

/// Largest difference over the largest value.
double relative_difference(const std::vector<double>& a, const std::vector<double>& b) {
  EXPECT_EQ(a.size(), b.size());
  double worst = 0, scale = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_TRUE(std::isfinite(a[i]) && std::isfinite(b[i])) << "value " << i;  // max() passes over NaN
    worst = std::max(worst, std::abs(a[i] - b[i]));
    scale = std::max(scale, std::abs(a[i]));
  }
  return scale > 0 ? worst / scale : worst;
}

double largest_difference(const Outcome& a, const Outcome& b) {
  return std::max({relative_difference(a.position, b.position), relative_difference(a.velocity, b.velocity),
                   relative_difference(a.stress, b.stress), relative_difference(a.temperature, b.temperature)});
}

TEST(RankCount, OneElasticStepG4) {
  const auto one = outcome(1, "spinning_block", {"time.most_steps=1"});
  for (int size : {2, 3, 4}) {
    const double difference = largest_difference(one, outcome(size, "spinning_block", {"time.most_steps=1"}));
    std::printf("G4, 1 step, %d ranks: %.1e\n", size, difference);
    EXPECT_LT(difference, 1e-13);
  }
}

TEST(RankCount, ThousandElasticStepsG4) {
  const auto one = outcome(1, "spinning_block", {});
  for (int size : {2, 3, 4}) {
    const double difference = largest_difference(one, outcome(size, "spinning_block", {}));
    std::printf("G4, 1000 elastic steps, %d ranks: %.1e\n", size, difference);
    EXPECT_LT(difference, 1e-10);
  }
}

TEST(RankCount, EverythingOnOneStepG4) {
  // One step, and the first heat solve at step 5: to the tolerance of the linear solve (1e-12 here).
  for (const char* steps : {"time.most_steps=1", "time.most_steps=5"}) {
    const std::vector<std::string> overrides{steps, "heat.relative_tolerance=1e-12"};
    const auto one = outcome(1, "mini_tube", overrides);
    for (int size : {2, 3, 4}) {
      const double difference = largest_difference(one, outcome(size, "mini_tube", overrides));
      std::printf("G4, mini tube, %s, %d ranks: %.1e\n", steps, size, difference);
      EXPECT_LT(difference, 1e-11);
    }
  }
}

/// Hourglass control, surface layers and reconstructed viscosity.
TEST(RankCount, FullCorrectionAndItsCompanionsG4) {
  const std::vector<std::string> overrides{"time.most_steps=4",
                                           "heat.mode=off",
                                           "numerics.gradient_correction=full",
                                           "time.cfl=0.3",
                                           "numerics.hourglass_control=1",
                                           "numerics.viscosity_reconstruction=true",
                                           "numerics.density_reconstruction=true"};
  const auto one = outcome(1, "mini_tube", overrides);
  for (int size : {2, 3, 4}) EXPECT_LT(largest_difference(one, outcome(size, "mini_tube", overrides)), 1e-11);
}

/// Rates of plastic flow that particles beside a grip share with others.
TEST(RankCount, RatesBesideGripsG4) {
  const std::vector<std::string> overrides{"grip.1.velocity.x=\"50 m/s\"", "time.most_steps=200"};
  const auto one = outcome(1, "plane_shear", overrides);
  for (int size : {2, 3, 4}) {
    const double difference = largest_difference(one, outcome(size, "plane_shear", overrides));
    std::printf("G4, plane shear, 200 steps, %d ranks: %.1e\n", size, difference);
    EXPECT_LT(difference, 1e-9);
  }
}

TEST(RankCount, TaylorBarLengthG4) {
  const std::vector<std::string> overrides{"numerics.spacing=0.8 mm"};
  const auto one = outcome(1, "c4_taylor_bar", overrides);
  const std::size_t length = 4, foot = 5;
  std::printf("Taylor bar, R/dx = 4: length %.4f mm, foot radius %.4f mm\n", 1e3 * one.diagnostics[length],
              1e3 * one.diagnostics[foot]);
  for (int size : {2, 3, 4}) {
    const auto other = outcome(size, "c4_taylor_bar", overrides);
    const double difference = std::abs(other.diagnostics[length] / one.diagnostics[length] - 1);
    std::printf("G4, Taylor bar, %d ranks: length differs by %.1e\n", size, difference);
    EXPECT_LT(difference, 1e-6);
  }
}

}  // namespace
}  // namespace stirsph::testing
