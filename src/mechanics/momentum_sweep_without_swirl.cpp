/// The momentum sweep of three dimensions with viscosity on the velocity without its swirl around the z axis.
#include "mechanics/mechanics_in.hpp"

namespace stirsph {

template <>
void MechanicsIn<Cartesian3>::sweep_momentum_without_swirl(std::size_t first, std::size_t last,
                                                           const MomentumConstants& constants, double* const* force,
                                                           double* dissipation, double* artificial_power) {
  const auto run = [&]<bool ArtificialStress, bool VariableH, bool Full>() {
    std::visit(
        [&]<class K>(const K&) {
          if (reconstructs_viscosity())
            momentum_sweep<Cartesian3, K, true, ArtificialStress, VariableH, Full, true, true>(
                records_, active_, first, last, constants, force, dissipation, artificial_power);
          else
            momentum_sweep<Cartesian3, K, true, ArtificialStress, VariableH, Full, true>(
                records_, active_, first, last, constants, force, dissipation, artificial_power);
        },
        settings_.kernel);
  };
  const auto with_correction = [&]<bool ArtificialStress, bool VariableH>() {
    settings_.gradient_correction == GradientCorrection::Full
        ? run.template operator()<ArtificialStress, VariableH, true>()
        : run.template operator()<ArtificialStress, VariableH, false>();
  };
  const auto with_h = [&]<bool ArtificialStress>() {
    settings_.variable_h ? with_correction.template operator()<ArtificialStress, true>()
                         : with_correction.template operator()<ArtificialStress, false>();
  };
  settings_.artificial_stress > 0 ? with_h.operator()<true>() : with_h.operator()<false>();
}

}  // namespace stirsph
