/// A material as the mechanics and the heat solver see it, and its data file.
#pragma once

#include <cmath>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include "input/parameters.hpp"
#include "materials/flow_stress.hpp"
#include "materials/grain_law.hpp"
#include "materials/thermal_properties.hpp"

namespace stirsph {

struct Material {
  std::string name;
  double density = 0;         ///< kg/m3 at zero volumetric strain
  double youngs_modulus = 0;  ///< Pa
  double poisson_ratio = 0;
  std::shared_ptr<const FlowStress> flow;  ///< null: the material stays elastic
  ThermalProperties thermal;
  double taylor_quinney = 0.9;  ///< share of plastic work that becomes heat (eq. 13)
  bool has_thermal = false;
  std::optional<GrainLaw> grain;

  double shear_modulus() const { return youngs_modulus / (2 * (1 + poisson_ratio)); }
  double bulk_modulus() const { return youngs_modulus / (3 * (1 - 2 * poisson_ratio)); }
  /// Dilatational wave speed sqrt((K + 4/3 G)/rho) [m/s].
  double sound_speed() const { return std::sqrt((bulk_modulus() + 4.0 / 3 * shear_modulus()) / density); }
};

/// The keys of a material data file (inputs/materials/*.toml).
const input::Schema& material_schema();
/// Reads a validated material.
Material make_material(const input::Parameters& parameters);
/// The flow stress models by keyword.
const std::map<std::string, input::Schema>& flow_stress_schemas();

/// Share of friction heat that goes to body a when it touches body b: f = 1/(1 + e_b/e_a), e = sqrt(rho c_p k) at T [K]
/// (paper eq. 15).
double heat_partition(const Material& a, const Material& b, double temperature);

}  // namespace stirsph
