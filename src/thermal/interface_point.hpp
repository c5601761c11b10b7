/// Where a particle exchanges heat with a rigid body.
#pragma once

#include <cstdint>
#include <vector>

namespace stirsph {

/// A node of a body's mesh and its share.
struct NodeWeight {
  std::int32_t node;
  double weight;
};

struct InterfacePoint {
  std::int32_t particle = 0;  ///< local index of an owned particle
  std::int32_t body = 0;      ///< index of the rigid body
  double distance = 0;        ///< m, particle centre to surface, positive outside the rigid body
  double area = 0;            ///< m2, the share of the interface that belongs to the particle
  double pressure = 0;        ///< Pa, normal contact pressure
  double heat = 0;            ///< J of friction heat for the body since the last heat solve
  /// m; when positive this is a hybrid path, without film: shape_factor times the harmonic mean of the conductivities.
  double shape_factor = 0;
  double kernel_sum = 0;            ///< sum of V W over the embedded particles of a hybrid path
  std::vector<NodeWeight> nodes{};  ///< of the body's mesh, weights sum to 1; empty for a body without a mesh
};

}  // namespace stirsph
