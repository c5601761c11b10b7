/// Run-time options -> compile-time momentum sweep. Included by one source file per space.
#pragma once

#include "mechanics/mechanics_in.hpp"

namespace stirsph {

template <class S>
void MechanicsIn<S>::sweep_momentum_reconstructed(std::size_t first, std::size_t last,
                                                  const MomentumConstants& constants, double* const* force,
                                                  double* dissipation, double* artificial_power) {
  const auto run = [&]<bool ArtificialStress, bool VariableH, bool Full>() {
    std::visit(
        [&]<class K>(const K&) {
          momentum_sweep<S, K, true, ArtificialStress, VariableH, Full, false, true>(
              records_, active_, first, last, constants, force, dissipation, artificial_power);
        },
        settings_.kernel);
  };
  const auto with_h = [&]<bool ArtificialStress, bool Full>() {
    settings_.variable_h ? run.template operator()<ArtificialStress, true, Full>()
                         : run.template operator()<ArtificialStress, false, Full>();
  };
  const bool artificial = settings_.artificial_stress > 0;
  if (settings_.gradient_correction == GradientCorrection::Full)
    artificial ? with_h.template operator()<true, true>() : with_h.template operator()<false, true>();
  else
    artificial ? with_h.template operator()<true, false>() : with_h.template operator()<false, false>();
}

template <class S>
void MechanicsIn<S>::sweep_momentum(std::size_t first, std::size_t last, const MomentumConstants& constants,
                                    double* const* force, double* dissipation, double* artificial_power) {
  if constexpr (S::dim == 3)
    if (viscosity_has_own_velocity())
      return sweep_momentum_without_swirl(first, last, constants, force, dissipation, artificial_power);
  if (reconstructs_viscosity())
    return sweep_momentum_reconstructed(first, last, constants, force, dissipation, artificial_power);
  const auto run = [&]<bool Viscous, bool ArtificialStress, bool VariableH>() {
    std::visit(
        [&]<class K>(const K&) {
          if (settings_.gradient_correction == GradientCorrection::Full)
            momentum_sweep<S, K, Viscous, ArtificialStress, VariableH, true>(records_, active_, first, last, constants,
                                                                             force, dissipation, artificial_power);
          else
            momentum_sweep<S, K, Viscous, ArtificialStress, VariableH, false>(records_, active_, first, last, constants,
                                                                              force, dissipation, artificial_power);
        },
        settings_.kernel);
  };
  const int choice = (viscous() ? 4 : 0) + (settings_.artificial_stress > 0 ? 2 : 0) + (settings_.variable_h ? 1 : 0);
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
    default:
      return run.template operator()<true, true, true>();
  }
}

}  // namespace stirsph
