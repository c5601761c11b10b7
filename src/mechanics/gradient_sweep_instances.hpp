/// Run-time options -> compile-time sweep, one dispatch per block of clusters. Included by one source file per space.
#pragma once

#include "mechanics/mechanics_in.hpp"

namespace stirsph {

template <class S>
void MechanicsIn<S>::sweep_gradient(const PairList& pairs, std::size_t first, std::size_t last, std::size_t owned,
                                    GradientBlock<S>& block) {
  const auto sweep = [&]<bool Corrected, bool Keep>() {
    with_gradient_record(settings_, [&]<bool VariableH, DensityDiffusion Diffusion>() {
      counters_.gradient_fallbacks += std::visit(
          [&]<class K>(const K&) {
            return velocity_gradient_sweep<S, K, Corrected, Diffusion, VariableH, Keep>(
                records_, pairs, first, last, owned, smoothing_length(), largest_correction_of(settings_), block,
                active_);
          },
          settings_.kernel);
    });
  };
  switch (settings_.gradient_correction) {
    case GradientCorrection::None:
      return sweep.template operator()<false, false>();
    case GradientCorrection::Velocity:
      return sweep.template operator()<true, false>();
    case GradientCorrection::Full:
      return sweep.template operator()<true, true>();
  }
}

}  // namespace stirsph
