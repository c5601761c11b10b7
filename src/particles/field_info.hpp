/// What the code knows about a particle field besides its values: exchange, checkpoint and snapshots derive from this,
/// so that none of them needs a list kept by hand.
#pragma once

#include <string_view>

namespace stirsph {

/// How many components a field has; the space turns the shape into a number, but for a list, which says it itself.
enum class Shape { Scalar, Position, Velocity, SymmetricTensor, Matrix, List };

/// When neighbours on other ranks need the field: after the drift, after the gradient sweep, after the stress update,
/// before a heat solve, or never.
enum class Halo { None, Static, Kinematic, Gradient, Stress, Thermal };

/// One declaration per field. Values are always double; identifiers and flags are whole numbers below 2^53.
struct FieldInfo {
  std::string_view name;
  std::string_view unit;     ///< SI; "1" when dimensionless
  std::string_view meaning;  ///< one line, used in files and in the manual
  Shape shape = Shape::Scalar;
  Halo halo = Halo::None;
  bool checkpoint = true;  ///< part of the state: migrates with its particle and is saved
  bool snapshot = false;   ///< written to snapshots unless the scene names its own list
};

}  // namespace stirsph
