/// Numerical choices of the mechanics; named in the scene's [numerics].
#pragma once

#include <algorithm>
#include <cmath>

#include "neighbours/smoothing_kernel.hpp"
#include "particles/inertia.hpp"

namespace stirsph {

/// Renormalisation of the kernel gradient by the inverse first moment M^-1 of the neighbourhood.
enum class GradientCorrection {
  None,
  Velocity,  ///< velocity gradient exact for linear fields; momentum sum plain (robust under a tool)
  Full,      ///< momentum sum as well, as the adjoint: linear momentum and energy conserved, right stiffness of free
             ///< surfaces
};

/// Smoothing of the volumetric strain between particles (delta-SPH), by its jumps or by what its gradients leave of
/// them.
enum class DensityDiffusion { Off, Plain, Reconstructed };

struct MechanicsSettings {
  Kernel kernel = CubicSpline{};
  double spacing = 0;       ///< m, initial particle spacing dx
  double h_over_dx = 1.3;   ///< smoothing length over spacing
  bool variable_h = false;  ///< h_i = h_0 (rho_0/rho_i)^(1/d) (paper eq. 7)
  GradientCorrection gradient_correction = GradientCorrection::None;
  double largest_correction = 0;          ///< bound on |M^-1|, see below; 0 = that of the correction
  double viscosity_alpha = 1;             ///< linear artificial viscosity (Monaghan)
  double viscosity_beta = 0;              ///< quadratic artificial viscosity
  bool viscosity_reconstruction = false;  ///< viscosity sees what a linear velocity field leaves of the approach
  double density_diffusion = 0;           ///< delta of delta-SPH, on the volumetric strain; 0 = off
  bool density_reconstruction = false;    ///< the diffusion sees what a linear field leaves of a jump
  double artificial_stress = 0;           ///< epsilon of Gray, Monaghan & Swift (2001); 0 = off
  double hourglass_control = 0;           ///< zeta of hourglass.hpp; 0 = off
  double density_scale = 1;               ///< s: inertial mass over physical mass
  double swirl_density_ratio = 1;         ///< the same of motion around the z axis, over s
  bool swirl_inertia = true;              ///< the swirl has its centrifugal and Coriolis forces
  bool viscosity_without_swirl = false;   ///< viscosity sees the velocity without its swirl around the z axis
  double elastic_scale = 1;               ///< factor on the elastic moduli (soft elasticity)
  bool surface_layers = false;            ///< contact needs the velocity gradient and its correction as fields
  bool rigid_grips = false;               ///< some particles belong to grips that move as rigid bodies (field held)
  bool heat_input = false;                ///< plastic heat is collected in the field heat_input
};

inline DensityDiffusion diffusion_of(const MechanicsSettings& settings) {
  if (settings.density_diffusion == 0) return DensityDiffusion::Off;
  return settings.density_reconstruction ? DensityDiffusion::Reconstructed : DensityDiffusion::Plain;
}

/// Calls f<VariableH, Diffusion>() with what the settings choose, so that packing and sweep have one form of record.
template <class F>
void with_gradient_record(const MechanicsSettings& settings, const F& f) {
  const auto with_h = [&]<DensityDiffusion Diffusion>() {
    settings.variable_h ? f.template operator()<true, Diffusion>() : f.template operator()<false, Diffusion>();
  };
  switch (diffusion_of(settings)) {
    case DensityDiffusion::Off:
      return with_h.template operator()<DensityDiffusion::Off>();
    case DensityDiffusion::Plain:
      return with_h.template operator()<DensityDiffusion::Plain>();
    case DensityDiffusion::Reconstructed:
      return with_h.template operator()<DensityDiffusion::Reconstructed>();
  }
}

/// The inertia they mean; `axisymmetric`: of the space.
inline Inertia inertia_of(const MechanicsSettings& settings, bool axisymmetric) {
  return {settings.density_scale,
          settings.swirl_density_ratio,
          settings.swirl_inertia,
          axisymmetric,
          axisymmetric ? 0.25 * settings.spacing : 0.5 * settings.spacing,
          axisymmetric ? settings.spacing : 0.0};
}

/// Largest |M^-1| (Frobenius) that a gradient is corrected with. Faces, edges and corners of a body have 2.7, 4.5 and
/// 7.02 (cubic spline), in disorder up to 14; in a plane faces and corners have 2.4 and 4.2. A chip of a dozen
/// particles has more, the acute corners of a sheared block up to 50. With the plain momentum sum such a correction is
/// a gain from velocity to stress that the forces do not have, and feeds the chip until it explodes: its gradient stays
/// plain. With the full one it makes the chip stiffer than the step bears: its strain oscillates from step to step and
/// makes heat, or it explodes. There the correction is scaled down to the bound, without a jump. The safe Courant
/// number of the full correction is that of the corner of a box.
inline double largest_correction_of(const MechanicsSettings& settings) {
  if (settings.largest_correction > 0) return settings.largest_correction;
  return settings.gradient_correction == GradientCorrection::Full ? 7.1 : 15;
}

/// The Courant number C of dt = C h/(c + |v|) that is safe for every kernel with viscosity_alpha up to 1, contact and
/// heat: 0.8 of the least limit that `tools/speed_study.py time_step` finds, and for `velocity` what a bar at 500 m/s
/// in rings needs (case K9.1; README.md beside this file).
inline double safe_courant_number(const MechanicsSettings& settings) {
  switch (settings.gradient_correction) {
    case GradientCorrection::Full:  // at bounds 7, 14, 25, 50 the limit is 0.64, 0.50, 0.46, 0.43 (README.md)
      return 0.5 * std::min(1.0, std::pow(7.1 / largest_correction_of(settings), 0.2));
    case GradientCorrection::Velocity:
      return 0.6;
    default:
      return 0.8;
  }
}

}  // namespace stirsph
