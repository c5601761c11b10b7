/// One material point driven through the code's own stress integration and return map.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "materials/material.hpp"
#include "mechanics/stress_point.hpp"
#include "particles/space.hpp"

namespace stirsph::testing {

/// State of the point and what it needs to heat up adiabatically.
struct MaterialPoint {
  Material material;
  double specific_heat = 0;  ///< J/kg/K; 0: no heating
  double temperature = 293.15;
  double plastic_strain = 0;
  double plastic_rate = 0;
  double flow_stress = 0;
  long iterations = 0;
  double s[6] = {};  ///< Pa, deviator

  /// One step of `dt` with the velocity gradient at the end of the step.
  void step(const LaneMatrix<double, 3>& gradient, double dt) {
    const auto deformation = step_deformation<Cartesian3>(to_midstep(gradient, dt), dt);
    double turned[6];
    elastic_trial<Cartesian3>(s, turned, deformation, material.shear_modulus(), dt);
    if (!material.flow) return;
    const double trial = equivalent_stress<Cartesian3>(s);
    double increment = 0;
    iterations += material.flow->return_map(
        {1, &trial, &plastic_strain, &temperature, dt, material.shear_modulus(), &increment, &flow_stress});
    plastic_rate = increment / dt;
    if (increment <= 0) return;
    plastic_return<Cartesian3>(turned, flow_stress, s);
    plastic_strain += increment;
    if (specific_heat > 0)
      temperature += material.taylor_quinney * flow_stress * increment / (material.density * specific_heat);
  }
  double equivalent() const { return equivalent_stress<Cartesian3>(s); }
};

/// L with only L_xy.
inline LaneMatrix<double, 3> simple_shear(double rate) {
  LaneMatrix<double, 3> gradient{};
  gradient.a[0][1] = rate;
  return gradient;
}
/// Isochoric compression along x.
inline LaneMatrix<double, 3> compression(double rate) {
  LaneMatrix<double, 3> gradient{};
  gradient.a[0][0] = -rate;
  gradient.a[1][1] = gradient.a[2][2] = 0.5 * rate;
  return gradient;
}

}  // namespace stirsph::testing
