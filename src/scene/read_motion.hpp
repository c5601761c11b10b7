/// Reads motions of a scene file: of rigid bodies, and the vectors and rotations that others use as well.
#pragma once

#include <array>
#include <optional>
#include <string>

#include "input/parameters.hpp"
#include "scene/scene.hpp"

namespace stirsph {

/// The table `key` with components x, y, z; those not given stay empty.
std::array<OptionalExpression, 3> vector_expression(const input::Parameters& p, const std::string& key);
/// The vector `key`, made a unit vector. Throws InputError for the zero vector.
Vec3 unit_vector(const input::Parameters& p, const std::string& key);
/// The table `rotation`, if it is given.
std::optional<RotationScene> rotation_of(const input::Parameters& p);
/// How a rigid body moves and turns.
MotionScene read_motion(const input::Parameters& p);

}  // namespace stirsph
