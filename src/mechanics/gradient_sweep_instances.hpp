/// Run-time options -> compile-time sweep, one dispatch per block of clusters. Included by one source file per space.
#pragma once

#include "mechanics/mechanics_in.hpp"

namespace stirsph {

template <class S>
void MechanicsIn<S>::sweep_gradient(const PairList& pairs, std::size_t first, std::size_t last, std::size_t owned,
                                    GradientBlock<S>& block) {
  const auto run = [&]<bool Corrected, bool Diffusion, bool VariableH, bool Keep = false>() {
    counters_.gradient_fallbacks += std::visit(
        [&]<class K>(const K&) {
          return velocity_gradient_sweep<S, K, Corrected, Diffusion, VariableH, Keep>(
              records_, pairs, first, last, owned, smoothing_length(), block, active_);
        },
        settings_.kernel);
  };
  const int choice = (settings_.gradient_correction == GradientCorrection::Full       ? 8
                      : settings_.gradient_correction == GradientCorrection::Velocity ? 4
                                                                                      : 0) +
                     (settings_.density_diffusion > 0 ? 2 : 0) + (settings_.variable_h ? 1 : 0);
  switch (choice) {
    case 0:
      return run.template operator()<false, false, false>();
    case 1:
      return run.template operator()<false, false, true>();
    case 2:
      return run.template operator()<false, true, false>();
    case 3:
      return run.template operator()<false, true, true>();
    case 4:
      return run.template operator()<true, false, false>();
    case 5:
      return run.template operator()<true, false, true>();
    case 6:
      return run.template operator()<true, true, false>();
    case 7:
      return run.template operator()<true, true, true>();
    case 8:
      return run.template operator()<true, false, false, true>();
    case 9:
      return run.template operator()<true, false, true, true>();
    case 10:
      return run.template operator()<true, true, false, true>();
    default:
      return run.template operator()<true, true, true, true>();
  }
}

}  // namespace stirsph
