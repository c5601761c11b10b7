/// Artificial stress against the tensile instability (Gray, Monaghan & Swift 2001): in principal axes, R = -epsilon
/// sigma for tensile principal stresses, zero for compressive ones. (The paper's 1/rho^2 is absorbed by the volume form
/// of the sweep.)
#pragma once

#include "base/tensor.hpp"
#include "particles/space.hpp"

namespace stirsph {

/// `stress` in storage order (dim x dim part used); writes the in-space components of `artificial`.
template <class S>
void artificial_stress(const double* stress, double epsilon, double* artificial);

extern template void artificial_stress<Cartesian3>(const double*, double, double*);
extern template void artificial_stress<PlaneStrain>(const double*, double, double*);

}  // namespace stirsph
