/// Flow stress models at the edges of their range, and the return map over a sweep of states.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "materials/material.hpp"

namespace stirsph {
namespace {

Material johnson_cook(const std::string& keys) {
  return make_material(
      input::parse_text("density = \"2785 kg/m3\"\n[elastic]\nyoungs_modulus = \"72.4 GPa\"\n"
                        "poisson_ratio = 0.33\n[flow_stress]\nmodel = \"johnson_cook\"\n"
                        "A = \"265 MPa\"\nreference_temperature = \"293.15 K\"\n"
                        "melting_temperature = \"823.15 K\"\n" +
                            keys,
                        "test.toml", material_schema()));
}

TEST(JohnsonCookEdges, RateFactor) {
  const auto clipped = johnson_cook("C = 0.015\n").flow,
             raw = johnson_cook("C = 0.015\nclip_rate_factor = false\n").flow;
  // At rest and up to the reference rate the clipped factor is 1; beyond it the two agree.
  for (double rate : {0.0, 1e-300, 1e-6, 0.5, 1.0}) EXPECT_EQ(clipped->value(0, rate, 293.15), 265e6) << rate;
  for (double rate : {1.0, 10.0, 1e4, 1e8})
    for (const auto& flow : {clipped, raw})
      EXPECT_NEAR(flow->value(0, rate, 293.15), 265e6 * (1 + 0.015 * std::log(rate)), 1e-6) << rate;
  EXPECT_NEAR(raw->value(0, 1e-3, 293.15), 265e6 * (1 + 0.015 * std::log(1e-3)), 1e-6);
  // Where the logarithm would take all strength away only the residual is left, and no NaN.
  for (double rate : {0.0, 1e-300, 1e-40}) EXPECT_EQ(raw->value(0, rate, 293.15), 2.65e6) << rate;
}

TEST(JohnsonCookEdges, Temperature) {
  const auto flow = johnson_cook("m = 1.31\n").flow;
  for (double t : {1.0, 200.0, 293.15}) EXPECT_EQ(flow->value(0, 0, t), 265e6) << t;  // no strengthening in the cold
  EXPECT_NEAR(flow->value(0, 0, 558.15), 265e6 * (1 - std::pow(0.5, 1.31)), 1e-6);
  for (double t : {823.15, 900.0, 5000.0}) EXPECT_EQ(flow->value(0, 0, t), 2.65e6) << t;  // default residual, 1 % of A
  EXPECT_NEAR(johnson_cook("residual_fraction = 0.2\n").flow->value(0, 0, 900), 53e6, 1e-6);
  double last = 1e300;
  for (double t = 250; t < 900; t += 1) {
    const double now = flow->value(0, 0, t);
    EXPECT_LE(now, last);
    last = now;
  }
}

TEST(JohnsonCookEdges, Hardening) {
  const auto flow = johnson_cook("B = \"292 MPa\"\nn = 0.31\n").flow;
  EXPECT_EQ(flow->value(0, 0, 293.15), 265e6);
  EXPECT_NEAR(flow->value(1, 0, 293.15), 557e6, 1e-6);
  EXPECT_NEAR(flow->value(0.2, 0, 293.15), 265e6 + 292e6 * std::pow(0.2, 0.31), 1e-6);
  // ep^0 = 1, at zero plastic strain as well: no step between rest and the first flow.
  const auto constant = johnson_cook("B = \"292 MPa\"\nn = 0\n").flow;
  EXPECT_NEAR(constant->value(0, 0, 293.15), 557e6, 1e-6);
  EXPECT_NEAR(constant->value(1e-12, 0, 293.15), 557e6, 1e-6);
}

TEST(ReturnMap, LandsOnTheYieldSurface) {
  struct Variant {
    std::string name, keys;
  };
  std::vector<Variant> variants;
  for (const char* hardening :
       {"", "B = \"292 MPa\"\nn = 0\n", "B = \"292 MPa\"\nn = 0.05\n", "B = \"292 MPa\"\nn = 0.1\n",
        "B = \"292 MPa\"\nn = 0.31\n", "B = \"292 MPa\"\nn = 1\n", "B = \"2 GPa\"\nn = 2\n"})
    for (const char* rate : {"", "C = 0.015\n", "C = 0.135\n", "C = 0.135\nclip_rate_factor = false\n"})
      variants.push_back({std::string(hardening) + rate, std::string(hardening) + rate + "m = 1.31\n"});
  double worst = 0;
  long yielding = 0, iterations = 0, most = 0;
  for (const Variant& variant : variants) {
    SCOPED_TRACE(variant.name);
    const Material m = johnson_cook(variant.keys);
    const double g = m.shear_modulus();
    for (double strain : {0.0, 1e-15, 1e-6, 0.1, 5.0})
      for (double temperature : {250.0, 500.0, 823.0, 900.0})
        for (double dt : {1e-10, 1e-7, 1e-3})
          // From a hair above the yield stress to far beyond it, and below it.
          for (double excess : {-0.5, -1e-9, 0.0, 1e-15, 1e-12, 1e-9, 1e-6, 1e-3, 0.3, 5.0, 1000.0}) {
            const double still = m.flow->value(strain, 0, temperature), trial = still * (1 + excess);
            double increment = -1, strength = -1;
            long needed = 0;
            ASSERT_NO_THROW(needed =
                                m.flow->return_map({1, &trial, &strain, &temperature, dt, g, &increment, &strength}))
                << "strain " << strain << " T " << temperature << " dt " << dt << " excess " << excess;
            if (trial <= still) {
              EXPECT_EQ(increment, 0);
              EXPECT_EQ(strength, still);
              continue;
            }
            yielding += 1;
            iterations += needed;
            most = std::max(most, needed);
            ASSERT_TRUE(increment >= 0 && 3 * g * increment <= trial);
            // Plastic work is never negative, the stress ends on the surface of the new strain and rate.
            const double surface = m.flow->value(strain + increment, increment / dt, temperature);
            const double error = std::abs(trial - 3 * g * increment - surface) / trial;
            if (increment < 1e-290) continue;
            worst = std::max(worst, error);
            // Round-off of the sums (return map: 1e-13), unless the strain is so small that it vanishes beside the old
            // one.
            EXPECT_LT(error, 1e-12) << "strain " << strain << " T " << temperature << " dt " << dt << " excess "
                                    << excess << " increment " << increment;
            EXPECT_NEAR(strength, trial - 3 * g * increment, 1e-12 * trial);
          }
  }
  std::printf(
      "%ld yielding states, distance from the surface %.1e of the trial stress, iterations: mean %.2f, most %ld\n",
      yielding, worst, static_cast<double>(iterations) / static_cast<double>(yielding), most);
}

}  // namespace
}  // namespace stirsph
