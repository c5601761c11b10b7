/// The spaces the mechanics is written over. A space is a compile-time parameter of every pair sweep, chosen once at
/// run time by the scene (`space = "cartesian3"`): nothing inside a sweep asks which space it is in.
#pragma once

#include <string>
#include <string_view>
#include <variant>

#include "base/tensor.hpp"

namespace stirsph {

/// Three dimensions, coordinates x y z.
struct Cartesian3 {
  static constexpr std::string_view keyword = "cartesian3";
  static constexpr int dim = 3;  ///< components of a position
  static constexpr int velocity_components = 3;
  static constexpr int stress_components = 6;  ///< xx yy zz xy xz yz
};

/// Two dimensions x y with D_zz = D_xz = D_yz = 0; quantities are those of a slab of 1 m thickness.
struct PlaneStrain {
  static constexpr std::string_view keyword = "plane_strain";
  static constexpr int dim = 2;
  static constexpr int velocity_components = 2;
  static constexpr int stress_components = 4;  ///< xx yy zz xy
};

/// The run-time name of a space; std::visit gives the compile-time type back.
using Space = std::variant<Cartesian3, PlaneStrain>;

/// Component counts of a space, for code that only stores or moves fields.
struct SpaceLayout {
  int dim;
  int velocity_components;
  int stress_components;
};

template <class S>
constexpr SpaceLayout layout_of() {
  return {S::dim, S::velocity_components, S::stress_components};
}
inline SpaceLayout layout_of(const Space& space) {
  return std::visit([]<class S>(const S&) { return layout_of<S>(); }, space);
}
inline std::string_view keyword_of(const Space& space) {
  return std::visit([]<class S>(const S&) { return S::keyword; }, space);
}

}  // namespace stirsph
