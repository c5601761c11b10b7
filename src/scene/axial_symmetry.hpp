/// Whether a scene can be computed in the axisymmetric space at all.
#pragma once

#include "scene/scene.hpp"

namespace stirsph {

/// Throws InputError when the space is axisymmetric and a body or rigid body is not round about the z axis, a rotation
/// is about another axis, or a velocity, a direction or a body force is not along z. Formulas of the initial velocity
/// of bodies and of grips are taken as they are in the half-plane y = 0, where x, y, z stand for r, theta, z.
void check_axial_symmetry(const Scene& scene);

}  // namespace stirsph
