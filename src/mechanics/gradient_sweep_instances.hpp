/// Run-time options -> compile-time sweep, one dispatch per block of clusters. Included by one source file per space.
#pragma once

#include "mechanics/mechanics_in.hpp"

namespace stirsph {

template <class S>
void MechanicsIn<S>::sweep_gradient(const PairList& pairs, std::size_t first, std::size_t last, std::size_t owned,
                                    GradientBlock<S>& block) {
  const auto run = [&]<bool Corrected, bool Keep, DensityDiffusion Diffusion, bool VariableH>() {
    counters_.gradient_fallbacks += std::visit(
        [&]<class K>(const K&) {
          return velocity_gradient_sweep<S, K, Corrected, Diffusion, VariableH, Keep>(
              records_, pairs, first, last, owned, smoothing_length(), block, active_);
        },
        settings_.kernel);
  };
  const auto with_h = [&]<bool Corrected, bool Keep, DensityDiffusion Diffusion>() {
    settings_.variable_h ? run.template operator()<Corrected, Keep, Diffusion, true>()
                         : run.template operator()<Corrected, Keep, Diffusion, false>();
  };
  const auto with_diffusion = [&]<bool Corrected, bool Keep>() {
    switch (diffusion_of(settings_)) {
      case DensityDiffusion::Off:
        return with_h.template operator()<Corrected, Keep, DensityDiffusion::Off>();
      case DensityDiffusion::Plain:
        return with_h.template operator()<Corrected, Keep, DensityDiffusion::Plain>();
      case DensityDiffusion::Reconstructed:
        return with_h.template operator()<Corrected, Keep, DensityDiffusion::Reconstructed>();
    }
  };
  switch (settings_.gradient_correction) {
    case GradientCorrection::None:
      return with_diffusion.template operator()<false, false>();
    case GradientCorrection::Velocity:
      return with_diffusion.template operator()<true, false>();
    case GradientCorrection::Full:
      return with_diffusion.template operator()<true, true>();
  }
}

}  // namespace stirsph
