/// Johnson-Cook flow stress (Johnson & Cook 1983; paper eq. 9):
/// sigma_y = [A + B ep^n] [1 + C ln(rate/rate0)] [1 - Tstar^m], Tstar = (T - T_reference)/(T_melt - T_reference) in [0,
/// 1].
#pragma once

#include "input/parameters.hpp"
#include "materials/flow_stress.hpp"

namespace stirsph {

struct JohnsonCook {
  static constexpr auto keyword = "johnson_cook";

  static void declare(input::Schema& s) {
    s.real("A", "yield stress at the reference rate and temperature").unit("Pa").positive();
    s.real("B", "hardening modulus").unit("Pa").not_negative().by_default("0 Pa");
    s.real("n", "hardening exponent").not_negative().by_default(0.0);
    s.real("C", "rate sensitivity").not_negative().by_default(0.0);
    s.real("m", "thermal softening exponent").positive().by_default(1.0);
    s.real("reference_rate", "plastic strain rate at which the rate factor is 1")
        .unit("1/s")
        .positive()
        .by_default("1 1/s");
    s.real("reference_temperature", "temperature below which there is no softening").unit("K").positive();
    s.real("melting_temperature", "temperature at which only the residual strength is left").unit("K").positive();
    s.real("residual_fraction",
           "strength left at the melting temperature, as a fraction of A, so that the material stays a solid")
        .range(1e-6, 1)
        .by_default(0.01);
    s.boolean("clip_rate_factor", "rate factor held at 1 below the reference rate").by_default("true");
  }
  explicit JohnsonCook(const input::Parameters& p)
      : A(p.real("A")),
        B(p.real("B")),
        n(p.real("n")),
        C(p.real("C")),
        m(p.real("m")),
        reference_rate(p.real("reference_rate")),
        reference_temperature(p.real("reference_temperature")),
        melting_temperature(p.real("melting_temperature")),
        residual(p.real("residual_fraction") * A),
        clip_rate_factor(p.boolean("clip_rate_factor")) {
    if (melting_temperature <= reference_temperature)
      p.fail("melting_temperature", "must be above reference_temperature");
  }

  bool rate_sensitive() const { return C > 0; }

  template <class T>
  FlowPoint<T> evaluate(const T& plastic_strain, const T& rate, const T& temperature) const {
    const T zero = 0.0, one = 1.0;
    T hardening = A, hardening_slope = 0.0;
    if (B > 0 && n == 0) {
      hardening += B;  // ep^0 = 1 at rest as well: a step at zero strain would leave stresses no flow can reach
    } else if (B > 0) {
      const auto hardened = plastic_strain > zero;
      const T strain = select(hardened, plastic_strain, one);
      const T power_term = select(hardened, T(B * power(strain, n)), zero);
      hardening += power_term;
      hardening_slope = n * power_term / strain;
    }
    T rate_factor = 1.0, rate_slope = 0.0;
    if (C > 0) {
      // Without clipping the logarithm tends to minus infinity at rest; the factor stops where strength would vanish.
      constexpr double least = 1e-3;
      const auto sensitive = rate > T(clip_rate_factor ? reference_rate : 0.0);
      const T faster = select(sensitive, T(rate / reference_rate), one);
      const T raw = select(sensitive, T(1 + C * logarithm(faster)), T(clip_rate_factor ? 1.0 : least));
      rate_factor = select(raw > T(least), raw, T(least));
      rate_slope = select(sensitive && raw > T(least), T(C / rate), zero);
    }
    T tstar = (temperature - reference_temperature) / (melting_temperature - reference_temperature);
    tstar = select(tstar > zero, tstar, zero);
    tstar = select(tstar < one, tstar, one);
    const T softening = 1.0 - (m == 1 ? tstar : power(tstar, m));
    const T stress = hardening * rate_factor * softening;
    const auto solid = stress > T(residual);
    return {select(solid, stress, T(residual)), select(solid, T(hardening_slope * rate_factor * softening), zero),
            select(solid, T(hardening * rate_slope * softening), zero)};
  }

  double A, B, n, C, m, reference_rate, reference_temperature, melting_temperature, residual;
  bool clip_rate_factor;
};

}  // namespace stirsph
