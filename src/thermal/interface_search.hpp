/// Finds where particles exchange heat with rigid bodies: feet on the exact surfaces, areas, places on the meshes.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "geometry/rigid_body.hpp"
#include "parallel/domain.hpp"
#include "particles/particle_set.hpp"
#include "thermal/hybrid_interface.hpp"
#include "thermal/interface_point.hpp"
#include "thermal/rigid_heat.hpp"

namespace stirsph {

/// A rigid body's interface with particles.
struct HeatInterface {
  int rigid = 0;             ///< index of the rigid body
  std::vector<bool> bodies;  ///< which particle bodies exchange heat with it
  bool hybrid = false;       ///< embedded particles instead of a film
  int component = -1;        ///< of field::rigid_heat and field::rigid_impulse; -1: no friction
};

/// Finds the points of all interfaces.
class InterfaceSearch {
 public:
  /// `rigids` and `heat` as given to take_points. `smoothing_length` [m] of the undisturbed lattice.
  InterfaceSearch(std::vector<HeatInterface> interfaces, std::span<const RigidBody> rigids,
                  std::span<const RigidHeat> heat, const Domain& domain, const SpaceLayout& layout,
                  const Kernel& kernel, double spacing, double smoothing_length);

  /// The points of owned particles, interface by interface, in storage order. Reads position, volume and body of halo
  /// copies. A particle holding friction heat for a body keeps a point without area where it has left the surface, so
  /// that no heat is lost. `elapsed` [s] since the last heat solve turns impulses into pressures. Empties rigid_heat
  /// and rigid_impulse.
  std::vector<InterfacePoint> take_points(ParticleSet& particles, std::span<const RigidBody> rigids,
                                          std::span<const RigidHeat> heat, double elapsed);

  /// Throws InputError when a particle sits inside a body or its mesh, or touches a shape where the mesh has no
  /// surface.
  void check_fit(const ParticleSet& particles, std::span<const RigidBody> rigids,
                 std::span<const RigidHeat> heat) const;

  const std::vector<HeatInterface>& interfaces() const { return interfaces_; }

 private:
  void check_overlap(const ParticleSet& particles, const HeatInterface& interface, const RigidBody& rigid) const;

  std::vector<HeatInterface> interfaces_;
  std::vector<std::unique_ptr<HybridInterface>> hybrids_;  ///< per interface; null for a film
  Domain domain_;
  SpaceLayout layout_;
  double spacing_;
};

/// Nodes and weights of a point in a mesh, in the body's frame. On a facetted surface the exact place may lie just
/// outside: then the nearest surface point stands for it. Throws InputError when the point is farther out than that.
std::vector<NodeWeight> nodes_around(const HeatMesh& mesh, const Vec3& point);

}  // namespace stirsph
