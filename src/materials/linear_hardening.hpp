/// Linear isotropic hardening sigma_y = yield_stress + hardening_modulus * ep; perfectly plastic when the modulus is
/// zero.
#pragma once

#include "input/parameters.hpp"
#include "materials/flow_stress.hpp"

namespace stirsph {

struct LinearHardening {
  static constexpr auto keyword = "linear_hardening";

  static void declare(input::Schema& s) {
    s.real("yield_stress", "initial yield stress").unit("Pa").positive();
    s.real("hardening_modulus", "slope of the flow stress over plastic strain").unit("Pa").not_negative();
  }
  explicit LinearHardening(const input::Parameters& p)
      : yield_stress(p.real("yield_stress")), hardening_modulus(p.real("hardening_modulus")) {}

  static bool rate_sensitive() { return false; }

  template <class T>
  FlowPoint<T> evaluate(const T& plastic_strain, const T&, const T&) const {
    return {yield_stress + hardening_modulus * plastic_strain, hardening_modulus, 0.0};
  }

  double yield_stress, hardening_modulus;
};

}  // namespace stirsph
