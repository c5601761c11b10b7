/// The material files of inputs/materials, the values derived from them and the flow stress models they name.
#include "materials/material.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <string>

#include "base/error.hpp"

namespace stirsph {
namespace {

const std::filesystem::path folder = std::filesystem::path(STIRSPH_SOURCE_DIR) / "inputs" / "materials";

Material from_file(const std::string& name) {
  return make_material(input::parse_file((folder / (name + ".toml")).string(), material_schema()));
}
Material from_text(const std::string& text) {
  return make_material(input::parse_text(text, "test.toml", material_schema()));
}

const std::string basis = R"(
density = "2785 kg/m3"
[elastic]
youngs_modulus = "72.4 GPa"
poisson_ratio = 0.33
)";

TEST(MaterialFiles, AllParseAndAreSane) {
  int count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().extension() != ".toml") continue;
    SCOPED_TRACE(entry.path().string());
    const Material m = make_material(input::parse_file(entry.path().string(), material_schema()));
    count += 1;
    EXPECT_FALSE(m.name.empty());
    EXPECT_GT(m.bulk_modulus(), 0);
    EXPECT_GT(m.shear_modulus(), 0);
    EXPECT_GT(m.sound_speed(), 3000);  // metals
    EXPECT_LT(m.sound_speed(), 8000);
    if (m.flow)
      for (double t : {200.0, 293.15, 600.0, 823.15, 1500.0}) {
        const double strength = m.flow->value(0.1, 10, t);
        EXPECT_TRUE(std::isfinite(strength) && strength > 0) << t << " K";
      }
    if (m.has_thermal)
      for (double t = 250; t <= 900; t += 25) {
        EXPECT_GT(m.thermal.conductivity(t), 0) << t << " K";
        EXPECT_GT(m.thermal.specific_heat(t), 0) << t << " K";
      }
  }
  EXPECT_EQ(count, 6);
}

TEST(MaterialFiles, ElasticConstantsOfTheCatalogue) {
  // Catalogue section 0, AL; its digits are the tolerance.
  const Material al = from_file("aa2024_t351");
  EXPECT_NEAR(al.bulk_modulus(), 70.98e9, 0.005e9);
  EXPECT_NEAR(al.shear_modulus(), 27.218e9, 0.0005e9);
  EXPECT_NEAR(al.sound_speed(), 6206.2, 0.05);
}

TEST(MaterialFiles, PolynomialsOfTheTemperatureInKelvin) {
  const Material m = from_file("aa6082_t6");
  // The polynomials evaluated by hand: 7.62 + 291.535 - 145.9433 + 25.15376 at 293 K, and so on.
  EXPECT_NEAR(m.thermal.conductivity(293), 178.3655, 1e-3);
  EXPECT_NEAR(m.thermal.conductivity(673), 212.0969, 1e-3);
  EXPECT_NEAR(m.thermal.specific_heat(293), 873.9151, 1e-3);
  EXPECT_NEAR(m.thermal.specific_heat(673), 1065.2071, 1e-3);
  std::printf("AA6082-T6: k(293 K) = %.3f, k(673 K) = %.3f W/m/K\n", m.thermal.conductivity(293),
              m.thermal.conductivity(673));
  // Held outside the stated range.
  EXPECT_EQ(m.thermal.conductivity(100), m.thermal.conductivity(200));
  EXPECT_EQ(m.thermal.conductivity(3000), m.thermal.conductivity(2000));
}

TEST(HeatPartition, AluminiumOnToolSteel) {
  const Material tool = from_file("aisi_h13");
  Material billet = from_file("aa2024_t351");
  const double with_file = heat_partition(billet, tool, 293.15);
  std::printf("heat partition AA2024/H13 at 293.15 K: %.5f\n", with_file);
  EXPECT_NEAR(with_file, 0.70, 0.01);  // the paper's two digits
  // Catalogue D5, c_p = 875 J/kg/K; five digits.
  billet.thermal.specific_heat.coefficients = {875};
  EXPECT_NEAR(heat_partition(billet, tool, 293.15), 0.69582, 5e-6);
  EXPECT_NEAR(heat_partition(billet, tool, 293.15) + heat_partition(tool, billet, 293.15), 1, 1e-15);
  EXPECT_NEAR(heat_partition(billet, billet, 400), 0.5, 1e-15);
}

TEST(MaterialInput, WithoutFlowStressItStaysElastic) {
  EXPECT_EQ(from_text(basis).flow, nullptr);
  EXPECT_EQ(from_text(basis + "[flow_stress]\nmodel = \"elastic\"\n").flow, nullptr);
  EXPECT_FALSE(from_text(basis).has_thermal);
}

TEST(MaterialInput, SimpleModels) {
  const Material plastic =
      from_text(basis + "[flow_stress]\nmodel = \"perfectly_plastic\"\nyield_stress = \"100 MPa\"\n");
  EXPECT_EQ(plastic.flow->value(3, 1e4, 500), 100e6);
  const Material linear = from_text(
      basis +
      "[flow_stress]\nmodel = \"linear_hardening\"\nyield_stress = \"400 MPa\"\nhardening_modulus = \"100 MPa\"\n");
  EXPECT_NEAR(linear.flow->value(0.5, 1e4, 500), 450e6, 1e-6);
}

TEST(MaterialInput, ErrorsAreInputErrors) {
  EXPECT_THROW(from_text("density = \"2785 kg/m3\"\n"), InputError);
  EXPECT_THROW(from_text(basis + "[flow_stress]\nmodel = \"no_such_model\"\n"), InputError);
  EXPECT_THROW(from_text(basis + "[flow_stress]\nmodel = \"johnson_cook\"\nA = \"265 MPa\"\n"
                                 "reference_temperature = \"800 K\"\nmelting_temperature = \"700 K\"\n"),
               InputError);
  EXPECT_THROW(from_text(basis + "[thermal]\nconductivity = [-1.0]\nspecific_heat = [900.0]\n"), InputError);
}

}  // namespace
}  // namespace stirsph
