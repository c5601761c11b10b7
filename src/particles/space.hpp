/// The spaces the mechanics is written over. A space is a compile-time parameter of every pair sweep, chosen once at
/// run time by the scene (`space = "cartesian3"`): nothing inside a sweep asks which space it is in.
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <variant>

#include "base/tensor.hpp"

namespace stirsph {

/// Three dimensions, coordinates x y z.
struct Cartesian3 {
  static constexpr std::string_view keyword = "cartesian3";
  static constexpr int dim = 3;                       ///< components of a position
  static constexpr std::array<int, 3> axes{0, 1, 2};  ///< the scene's axis, and velocity component, of each of them
  static constexpr int velocity_components = 3;
  static constexpr int tensor_dim = 3;         ///< size of the velocity gradient as a matrix
  static constexpr int stress_components = 6;  ///< xx yy zz xy xz yz
};

/// Two dimensions x y with D_zz = D_xz = D_yz = 0; quantities are those of a slab of 1 m thickness.
struct PlaneStrain {
  static constexpr std::string_view keyword = "plane_strain";
  static constexpr int dim = 2;
  static constexpr std::array<int, 3> axes{0, 1, 2};
  static constexpr int velocity_components = 2;
  static constexpr int tensor_dim = 2;
  static constexpr int stress_components = 4;  ///< xx yy zz xy
};

/// Axial symmetry about z with rotation: the half-plane of r and z, all three velocities and all six stresses, in the
/// order r theta z. A particle is a whole ring; masses, volumes, forces and torques are those of the ring. In the
/// scene's frame it stands for the place (r, 0, z), where the directions r, theta, z are those of x, y, z: shapes,
/// rigid bodies and contact are those of the three-dimensional scene.
struct AxisymmetricSwirl {
  static constexpr std::string_view keyword = "axisymmetric";
  static constexpr int dim = 2;
  static constexpr std::array<int, 3> axes{0, 2, 1};
  static constexpr int velocity_components = 3;
  static constexpr int tensor_dim = 3;
  static constexpr int stress_components = 6;  ///< rr tt zz rt rz tz
};

/// The run-time name of a space; std::visit gives the compile-time type back.
using Space = std::variant<Cartesian3, PlaneStrain, AxisymmetricSwirl>;

/// Component counts of a space, for code that only stores or moves fields.
struct SpaceLayout {
  int dim;
  int velocity_components;
  int stress_components;
  std::array<int, 3> axes;  ///< the scene's axis of each component of a position

  bool axisymmetric() const { return axes[1] == 2; }
};

/// Storage index of the component (i, j), i <= j, of a symmetric tensor, counted by the components of a position.
template <class S>
constexpr int in_plane_index(int i, int j) {
  return symmetric_index(S::axes[static_cast<std::size_t>(i)], S::axes[static_cast<std::size_t>(j)]);
}

template <class S>
constexpr SpaceLayout layout_of() {
  return {S::dim, S::velocity_components, S::stress_components, S::axes};
}
inline SpaceLayout layout_of(const Space& space) {
  return std::visit([]<class S>(const S&) { return layout_of<S>(); }, space);
}
inline std::string_view keyword_of(const Space& space) {
  return std::visit([]<class S>(const S&) { return S::keyword; }, space);
}

}  // namespace stirsph
