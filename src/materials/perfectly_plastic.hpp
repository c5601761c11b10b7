/// Constant flow stress.
#pragma once

#include "input/parameters.hpp"
#include "materials/flow_stress.hpp"

namespace stirsph {

struct PerfectlyPlastic {
  static constexpr auto keyword = "perfectly_plastic";

  static void declare(input::Schema& s) { s.real("yield_stress", "constant flow stress").unit("Pa").positive(); }
  explicit PerfectlyPlastic(const input::Parameters& p) : yield_stress(p.real("yield_stress")) {}

  static bool rate_sensitive() { return false; }

  template <class T>
  FlowPoint<T> evaluate(const T&, const T&, const T&) const {
    return {yield_stress, 0.0, 0.0};
  }

  double yield_stress;
};

}  // namespace stirsph
