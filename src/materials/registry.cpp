/// The table of flow stress models: one include and one line each.
#include <functional>

#include "materials/johnson_cook.hpp"
#include "materials/linear_hardening.hpp"
#include "materials/material.hpp"
#include "materials/perfectly_plastic.hpp"

namespace stirsph {
namespace {

class Models {
 public:
  template <class Model>
  void add() {
    input::Schema schema;
    Model::declare(schema);
    schemas[Model::keyword] = schema;
    makers[Model::keyword] = [](const input::Parameters& p) {
      return std::make_shared<const FlowStressOf<Model>>(Model(p));
    };
  }
  std::map<std::string, input::Schema> schemas;
  std::map<std::string, std::function<std::shared_ptr<const FlowStress>(const input::Parameters&)>> makers;
};

const Models& models() {
  static const Models table = [] {
    Models m;
    m.schemas["elastic"] = input::Schema("no yielding");
    m.makers["elastic"] = [](const input::Parameters&) { return nullptr; };
    m.add<PerfectlyPlastic>();
    m.add<LinearHardening>();
    m.add<JohnsonCook>();
    return m;
  }();
  return table;
}

void declare_grain_law(input::Schema& s) {
  s.real("activation_energy", "Q of the Zener-Hollomon parameter Z = rate exp(Q/(R T))").unit("J/mol").positive();
  s.real("intercept", "of d^exponent = intercept + slope ln Z, d the grain diameter in um, rate in 1/s");
  s.real("slope", "see intercept").positive();
  s.real("exponent", "see intercept").range(-10, -0.1);
  s.real("initial_grain_size", "diameter before any recrystallisation").unit("m").positive();
  s.real("hardness_intercept", "of HV = hardness_intercept + hardness_slope d^-1/2, d in um").not_negative();
  s.real("hardness_slope", "see hardness_intercept").not_negative();
}

GrainLaw make_grain_law(const input::Parameters& p) {
  GrainLaw law;
  law.activation_energy = p.real("activation_energy");
  law.intercept = p.real("intercept");
  law.slope = p.real("slope");
  law.exponent = p.real("exponent");
  law.initial_grain_size = p.real("initial_grain_size");
  law.hardness_intercept = p.real("hardness_intercept");
  law.hardness_slope = p.real("hardness_slope");
  return law;
}

}  // namespace

const std::map<std::string, input::Schema>& flow_stress_schemas() { return models().schemas; }

const input::Schema& material_schema() {
  static const input::Schema schema = [] {
    input::Schema s("a material data file");
    s.text("name", "designation").by_default("unnamed");
    s.text("source", "where the numbers come from").by_default("not stated");
    s.real("density", "mass density at zero stress").unit("kg/m3").range(1, 3e4);
    input::Schema& elastic = s.table("elastic", "isotropic Hooke's law");
    elastic.real("youngs_modulus", "Young's modulus").unit("Pa").positive();
    elastic.real("poisson_ratio", "Poisson's ratio").range(-0.99, 0.4999);
    s.variant("flow_stress", "model", flow_stress_schemas, "flow stress; without it the material stays elastic")
        .optional();
    input::Schema& thermal = s.table("thermal", "heat conduction and plastic heating", true);
    thermal.reals("conductivity", "polynomial coefficients of k(T) in W/m/K, T in K: c0, c1, ...").count(1, 8);
    thermal.reals("specific_heat", "polynomial coefficients of c_p(T) in J/kg/K, T in K: c0, c1, ...").count(1, 8);
    thermal.real("lowest_temperature", "the polynomials are held below this temperature")
        .unit("K")
        .positive()
        .by_default("200 K");
    thermal.real("highest_temperature", "the polynomials are held above this temperature")
        .unit("K")
        .positive()
        .by_default("2000 K");
    thermal.real("taylor_quinney", "share of plastic work that becomes heat").range(0, 1).by_default(0.9);
    declare_grain_law(s.table("microstructure", "grain size after recrystallisation, and hardness", true));
    return s;
  }();
  return schema;
}

Material make_material(const input::Parameters& p) {
  Material material;
  material.name = p.text("name");
  material.density = p.real("density");
  material.youngs_modulus = p.table("elastic").real("youngs_modulus");
  material.poisson_ratio = p.table("elastic").real("poisson_ratio");
  if (p.has("flow_stress")) {
    const input::Parameters flow = p.table("flow_stress");
    material.flow = models().makers.at(flow.text("model"))(flow);
  }
  if (p.has("thermal")) {
    const input::Parameters thermal = p.table("thermal");
    const double lowest = thermal.real("lowest_temperature"), highest = thermal.real("highest_temperature");
    material.thermal.conductivity = {thermal.reals("conductivity"), lowest, highest};
    material.thermal.specific_heat = {thermal.reals("specific_heat"), lowest, highest};
    material.taylor_quinney = thermal.real("taylor_quinney");
    material.has_thermal = true;
    for (double t : {lowest, 0.5 * (lowest + highest), highest})
      if (material.thermal.specific_heat(t) <= 0 || material.thermal.conductivity(t) <= 0)
        thermal.fail("conductivity", "conductivity or specific heat is not positive at " + std::to_string(t) +
                                         " K; narrow lowest_temperature .. highest_temperature");
  }
  if (p.has("microstructure")) material.grain = make_grain_law(p.table("microstructure"));
  return material;
}

double heat_partition(const Material& a, const Material& b, double temperature) {
  const auto effusivity = [temperature](const Material& m) {
    return std::sqrt(m.density * m.thermal.specific_heat(temperature) * m.thermal.conductivity(temperature));
  };
  return 1 / (1 + effusivity(b) / effusivity(a));
}

}  // namespace stirsph
