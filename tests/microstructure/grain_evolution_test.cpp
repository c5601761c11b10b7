/// Grain size along a driven history of strain rate and temperature: section H of the verification catalogue through
/// the fields, the frozen-in rule, and steps of any size.
#include "microstructure/grain_evolution.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <functional>

#include "materials/material.hpp"
#include "microstructure/grain.hpp"
#include "particles/field_names.hpp"

namespace stirsph {
namespace {

const GrainLaw& law() {
  static const GrainLaw paper =
      *make_material(
           input::parse_file(std::string(STIRSPH_SOURCE_DIR) + "/inputs/materials/aa2024_t351.toml", material_schema()))
           .grain;
  return paper;
}

constexpr double window = 0.05;  // s
const RecrystallisationRule rule{window, 1e-6, 400, 0};

struct Outcome {
  double rate, grain, hardness;
  bool recrystallised;
};

/// One particle whose strain is a given function of time; the steps do not divide the window.
Outcome driven(const std::function<double(double)>& strain, const std::function<double(double)>& temperature,
               double end, double dt, const RecrystallisationRule& with = rule) {
  ParticleSet particles(layout_of<Cartesian3>());
  for (const FieldInfo* info :
       {&field::material, &field::temperature, &field::equivalent_plastic_strain, &field::plastic_strain_rate})
    particles.add(*info);
  GrainEvolution::add_fields(particles);
  particles.resize_owned(1);
  const GrainEvolution evolution(with, {law()});
  evolution.initialise(particles);
  double time = 0;
  while (time < end) {
    const double next = time + dt;
    particles[field::equivalent_plastic_strain][0] = strain(next);
    particles[field::plastic_strain_rate][0] = (strain(next) - strain(time)) / dt;
    particles[field::temperature][0] = temperature(next);
    evolution.update(particles, time, next);
    time = next;
  }
  return {particles[field::strain_rate_average][0], particles[field::grain_size][0], hardness_of(particles, {law()}, 0),
          particles[field::recrystallised][0] == 1};
}

std::function<double(double)> constant(double value) {
  return [value](double) { return value; };
}

struct Row {
  double rate, temperature, grain, hardness;
};
constexpr Row table[] = {
    {0.1, 573.15, 3.25609, 108.613}, {1, 573.15, 2.90338, 109.888},  {10, 573.15, 2.62640, 111.065},
    {100, 573.15, 2.40255, 112.161}, {1, 673.15, 3.63167, 107.465},  {10, 673.15, 3.18858, 108.841},
    {100, 673.15, 2.85106, 110.097}, {10, 723.15, 3.49614, 107.858}, {100, 773.15, 3.33136, 108.368},
    {1e-3, 823.15, 18.2432, 96.131},
};

TEST(GrainEvolution, TableOfTheCatalogueInTheFields) {
  constexpr double tolerance = 1e-5;  // the table has six digits
  double worst = 0;
  for (const Row& row : table) {
    const Outcome result = driven([&](double t) { return row.rate * t; }, constant(row.temperature), 0.2, 0.0007);
    ASSERT_TRUE(result.recrystallised) << row.rate << " 1/s, " << row.temperature << " K";
    EXPECT_NEAR(result.rate, row.rate, 1e-9 * row.rate);
    EXPECT_NEAR(result.grain, 1e-6 * row.grain, tolerance * 1e-6 * row.grain);
    EXPECT_NEAR(result.hardness, row.hardness, tolerance * row.hardness);
    worst =
        std::max({worst, std::abs(1e6 * result.grain / row.grain - 1), std::abs(result.hardness / row.hardness - 1)});
  }
  std::printf("H through the fields: largest relative difference from the table %.1e\n", worst);
}

TEST(GrainEvolution, InitialGrainWhereTheLawHasNoValueOrNothingFlows) {
  // 1.767e-4 1/s at 823.15 K is the end of the law.
  for (const double rate : {0.0, 1e-5, 1.766e-4}) {
    const Outcome none = driven([&](double t) { return rate * t; }, constant(823.15), 0.2, 0.0007);
    EXPECT_FALSE(none.recrystallised) << rate;
    EXPECT_EQ(none.grain, law().initial_grain_size);
    EXPECT_NEAR(none.hardness, 87 + 39 / std::sqrt(30.0), 1e-12);
    EXPECT_NEAR(none.rate, rate, 1e-9 * rate);
  }
  EXPECT_TRUE(driven([&](double t) { return 1.768e-4 * t; }, constant(823.15), 0.2, 0.0007).recrystallised);
}

TEST(GrainEvolution, NothingBelowTheThresholds) {
  RecrystallisationRule strict = rule;
  strict.least_rate = 2;
  EXPECT_FALSE(driven([](double t) { return 1.9 * t; }, constant(700), 0.2, 0.001, strict).recrystallised);
  EXPECT_TRUE(driven([](double t) { return 2.1 * t; }, constant(700), 0.2, 0.001, strict).recrystallised);
  strict.least_temperature = 700;
  EXPECT_FALSE(driven([](double t) { return 2.1 * t; }, constant(699), 0.2, 0.001, strict).recrystallised);
}

TEST(GrainEvolution, FrozenAfterTheLastDeformation) {
  // Flow at 10 1/s and 700 K until 0.2 s, then rest while it cools: the grain keeps what belongs to the flow.
  const auto strain = [](double t) { return 10 * std::min(t, 0.2); };
  const auto temperature = [](double t) { return t <= 0.2 ? 700 : 700 - 500 * (t - 0.2); };
  const double expected = 1e-6 * *recrystallised_grain_size(law(), 10, 700);
  // A step over the sudden end of flow leaves up to 10 1/s dt/(4 window) = 0.035 1/s to the window after it.
  RecrystallisationRule usual = rule;
  usual.least_rate = 0.1;
  const Outcome after = driven(strain, temperature, 0.8, 0.0007, usual);
  EXPECT_NEAR(after.grain, expected, 5e-4 * expected);  // the same 0.035 1/s are missing in the window before
  EXPECT_NEAR(after.rate, 0, 1e-12) << "the average forgets, the grain does not";
  // Slower and colder flow later counts again.
  const auto twice = [](double t) { return 10 * std::min(t, 0.2) + 1 * std::max(0.0, t - 0.5); };
  const Outcome second = driven(twice, constant(600), 0.9, 0.0007, usual);
  EXPECT_NEAR(second.grain, 1e-6 * *recrystallised_grain_size(law(), 1, 600), 1e-6 * expected);
}

TEST(GrainEvolution, StepsOfAnySizeGiveTheSame) {
  const auto strain = [](double t) { return 3 * t + std::sin(40 * t) / 20; };
  const auto temperature = [](double t) { return 600 + 100 * t; };
  // 0.93 s: no window ends there, so that every step size sees the same windows.
  const double reference = driven(strain, temperature, 0.93, 1e-5).grain;
  for (const double dt : {0.001, 0.0005, 0.00037}) {
    const double difference = driven(strain, temperature, 0.93, dt).grain / reference - 1;
    std::printf("dt = %g window: grain differs by %.1e\n", dt / window, difference);
    // The temperature is that of the end of the step: up to 0.1 K, 2e-4 of the grain size. Strains are interpolated.
    EXPECT_LT(std::abs(difference), 2e-4) << dt;
  }
  // A step may hold several windows.
  const Outcome coarse = driven([](double t) { return 5 * t; }, constant(650), 1.0, 0.12);
  EXPECT_NEAR(coarse.rate, 5, 1e-9);
}

/// Renewal over a strain: the grain is a mean over the last deformation, not only what its end leaves.
TEST(GrainEvolution, RenewalOverAStrain) {
  RecrystallisationRule gradual = rule;
  gradual.renewal_strain = 0.5;
  const double fast = *recrystallised_grain_size(law(), 10, 700);
  // Strain 2: the share exp(-4) of the initial grains is left.
  const Outcome result = driven([](double t) { return 10 * t; }, constant(700), 0.2001, 0.0003, gradual);
  EXPECT_NEAR(1e6 * result.grain, fast + (30 - fast) * std::exp(-4.0), 1e-6);
}

/// The example of src/microstructure/README.md: flow that dies away leaves the grains of the threshold rate, unless
/// renewal takes a strain.
TEST(GrainEvolution, FlowThatDiesAway) {
  const auto strain = [](double t) { return t < 0.3 ? 10 * t : 3 + 2 * (1 - std::exp(-(t - 0.3) / 0.2)); };
  RecrystallisationRule usual = rule;
  usual.least_rate = 0.1;
  const double at_once = 1e6 * driven(strain, constant(700), 3, 0.0007, usual).grain;
  usual.renewal_strain = 0.5;
  const double gradual = 1e6 * driven(strain, constant(700), 3, 0.0007, usual).grain;
  const double steady = *recrystallised_grain_size(law(), 10, 700), slow = *recrystallised_grain_size(law(), 0.1, 700);
  std::printf(
      "flow dying away: %.3f um, with renewal over a strain of 0.5 %.3f um; of 10 1/s %.3f um, of 0.1 1/s %.3f um\n",
      at_once, gradual, steady, slow);
  EXPECT_NEAR(at_once, 4.475, 0.001);
  EXPECT_NEAR(gradual, 3.750, 0.001);
  EXPECT_NEAR(steady, 3.351, 0.001);
}

}  // namespace
}  // namespace stirsph
