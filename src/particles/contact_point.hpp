/// Where a particle touches a rigid body: found once by the contact search, used by forces and by heat exchange.
#pragma once

#include <cstdint>

#include "base/tensor.hpp"

namespace stirsph {

struct ContactPoint {
  std::int32_t particle = 0;  ///< local index of an owned particle
  std::int32_t body = 0;      ///< index of the rigid body in the scene
  double distance = 0;        ///< m, particle centre to surface, positive outside the rigid body
  double area = 0;            ///< m2, the share of the contact surface that belongs to the particle
  double pressure = 0;        ///< Pa, normal contact pressure of the last step
  Vec3 normal;                ///< outward unit normal of the rigid surface
};

}  // namespace stirsph
