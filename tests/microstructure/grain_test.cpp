/// Grain size and hardness against the verification catalogue, section H, and outside the range of the law.
#include "microstructure/grain.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <limits>

#include "materials/material.hpp"

namespace stirsph {
namespace {

/// The paper's constants, from the file that a scene would read.
const GrainLaw& law() {
  static const GrainLaw paper =
      *make_material(
           input::parse_file(std::string(STIRSPH_SOURCE_DIR) + "/inputs/materials/aa2024_t351.toml", material_schema()))
           .grain;
  return paper;
}

struct Row {
  double rate, temperature, log_z, grain, hardness;
};
constexpr Row table[] = {
    {0.1, 573.15, 26.0280, 3.25609, 108.613}, {1, 573.15, 28.3306, 2.90338, 109.888},
    {10, 573.15, 30.6332, 2.62640, 111.065},  {100, 573.15, 32.9357, 2.40255, 112.161},
    {1, 673.15, 24.1219, 3.63167, 107.465},   {10, 673.15, 26.4245, 3.18858, 108.841},
    {100, 673.15, 28.7271, 2.85106, 110.097}, {10, 723.15, 24.7567, 3.49614, 107.858},
    {100, 773.15, 25.6071, 3.33136, 108.368}, {1e-3, 823.15, 12.8185, 18.2432, 96.131},
};

TEST(Grain, TableOfTheCatalogue) {
  // 1e-5: the table has six digits. Measured: 4.6e-6 (its rounding).
  constexpr double tolerance = 1e-5;
  double worst = 0;
  for (const Row& row : table) {
    const double log_z = log_zener_hollomon(law(), row.rate, row.temperature);
    const auto grain = recrystallised_grain_size(law(), row.rate, row.temperature);
    ASSERT_TRUE(grain.has_value()) << row.rate << " 1/s, " << row.temperature << " K";
    const double hardness = hall_petch_hardness(law(), *grain);
    EXPECT_NEAR(log_z, row.log_z, tolerance * row.log_z);
    EXPECT_NEAR(*grain, row.grain, tolerance * row.grain);
    EXPECT_NEAR(hardness, row.hardness, tolerance * row.hardness);
    worst = std::max({worst, std::abs(log_z / row.log_z - 1), std::abs(*grain / row.grain - 1),
                      std::abs(hardness / row.hardness - 1)});
  }
  std::printf("largest relative difference from the table: %.2e\n", worst);
}

TEST(Grain, NotRecrystallisedWhereTheLawHasNoValue) {
  EXPECT_FALSE(recrystallised_grain_size(law(), 0.0, 700).has_value());
  EXPECT_FALSE(recrystallised_grain_size(law(), -1.0, 700).has_value());
  EXPECT_FALSE(recrystallised_grain_size(law(), 1.0, 0.0).has_value());
  EXPECT_FALSE(recrystallised_grain_size(law(), 1.0, -5.0).has_value());
  EXPECT_FALSE(recrystallised_grain_size(law(), std::numeric_limits<double>::quiet_NaN(), 700).has_value());
  EXPECT_FALSE(recrystallised_grain_size(law(), 1.0, std::numeric_limits<double>::quiet_NaN()).has_value());
  // ln Z = 0.1696/0.0153 = 11.08497 is where the law ends: 1.767e-4 1/s at 823.15 K.
  EXPECT_FALSE(recrystallised_grain_size(law(), 1.766e-4, 823.15).has_value());
  ASSERT_TRUE(recrystallised_grain_size(law(), 1.768e-4, 823.15).has_value());
}

TEST(Grain, NeverNotANumber) {
  int empty = 0, finite = 0;
  for (double rate = 1e-12; rate < 1e9; rate *= 3)
    for (double temperature = 100; temperature < 2000; temperature += 37) {
      const auto grain = recrystallised_grain_size(law(), rate, temperature);
      if (!grain) {
        empty += 1;
        continue;
      }
      finite += 1;
      EXPECT_TRUE(std::isfinite(*grain) && *grain > 0) << rate << " " << temperature;
      EXPECT_TRUE(std::isfinite(hall_petch_hardness(law(), *grain))) << rate << " " << temperature;
    }
  EXPECT_GT(empty, 0);
  EXPECT_GT(finite, 0);
}

TEST(Grain, FinerWhenFasterAndColder) {
  EXPECT_LT(*recrystallised_grain_size(law(), 100, 700), *recrystallised_grain_size(law(), 10, 700));
  EXPECT_LT(*recrystallised_grain_size(law(), 10, 650), *recrystallised_grain_size(law(), 10, 700));
  EXPECT_GT(hall_petch_hardness(law(), 2), hall_petch_hardness(law(), 4));
}

}  // namespace
}  // namespace stirsph
