/// The paper's hybrid coupling: particles embedded in the elements of a rigid body next to its surface carry the
/// temperature of the mesh, and billet particles exchange heat with them as with their own kind (section 2.4 of the
/// paper), so that both form one thermal medium without a film.
///
/// The embedded particles sit on a lattice of the billet's spacing that travels with the body. They are not unknowns:
/// their temperature is the mesh's at their place. All paths of one billet particle are joined into one, to the mean of
/// the embedded temperatures weighted with the conductances: the flow is the same, and the nodes share it by weight.
#pragma once

#include <cstdint>
#include <unordered_map>
#include <vector>

#include "geometry/rigid_body.hpp"
#include "neighbours/smoothing_kernel.hpp"
#include "particles/particle_set.hpp"
#include "thermal/interface_point.hpp"
#include "thermal/rigid_heat.hpp"

namespace stirsph {

class HybridInterface {
 public:
  /// `mesh` and `shape` must outlive this. `smoothing_length` [m] of the embedded particles.
  HybridInterface(const HeatMesh& mesh, const ShapeFunction& shape, const Kernel& kernel, const SpaceLayout& layout,
                  double spacing, double smoothing_length);

  /// The path of one particle at a place [m, body's frame; of a ring anywhere on it]; its `shape_factor` is zero when
  /// none is near.
  InterfacePoint point_at(const Vec3& at, double volume, double smoothing_length);
  double reach() const { return reach_; }  ///< m from the surface beyond which there is no path

 private:
  const std::vector<NodeWeight>& embedded_at(const std::array<int, 3>& site, const Vec3& place);

  const HeatMesh& mesh_;
  const ShapeFunction& shape_;
  ElementSearch elements_;
  Kernel kernel_;
  SpaceLayout layout_;
  double spacing_, smoothing_length_, reach_;
  /// Nodes of each lattice site met so far; none for a site outside the body.
  std::unordered_map<std::uint64_t, std::vector<NodeWeight>> sites_;
};

}  // namespace stirsph
