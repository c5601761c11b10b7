/// The area of a rigid surface that belongs to each particle touching it.
///
/// The surface is shared out by a partition of unity over the feet, the points of the surface nearest to the particles:
///   A_i = integral over the tangent plane at p_i of c(q) w_i(q) / sum_j w_j(q),   w_j(q) = m(distance_j) w(|q - p_j|)
/// so that the areas sum to the touched area whatever the arrangement. c(q) says whether the surface is touched at q:
/// it falls from 1 to 0 where the weighted mean of the feet around q lies half a spacing aside, which is where the
/// outermost row of a lattice ends. Unlike a density of feet, this does not depend on how many particles of a staircase
/// lie behind each other. README.md has the measured errors.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/tensor.hpp"
#include "particles/space.hpp"

namespace stirsph {

/// Foot of a particle on a rigid body's surface, at one instant.
struct SurfaceFoot {
  std::int32_t particle = 0;  ///< local index, owned or halo copy
  Vec3 point;                 ///< m
  Vec3 normal;                ///< outward unit normal of the rigid surface
  double distance = 0;        ///< m, particle centre to surface
};

/// Feet of particles at this distance from the surface or farther, in spacings, are ignored. A lattice filled into a
/// curved shape with the usual margin of 1/4 has first layers up to 1.25 away where the surface runs along it; the
/// second layer of a flat wall is 1.5 away. The share of a single particle that moves away fades out; a body that lifts
/// off as a whole loses its contact at once.
inline constexpr double contact_reach = 1.4;

/// Feet farther apart than this, in spacings, do not affect each other: how far feet of halo copies are needed.
inline constexpr double contact_neighbourhood = 2.6;

/// Area [m2; m in plane strain] of each of the first `owned` feet; the others are of halo copies that share the
/// surface. All feet are on the same rigid body. Feet whose normals differ by more than 60 degrees do not share: they
/// are on two sides of a thin wall or of an edge. In the axisymmetric space feet are in the half-plane (r, 0, z), those
/// on the far side of the axis are made here, and an area is that of the ring through the foot.
std::vector<double> contact_areas(std::span<const SurfaceFoot> feet, std::size_t owned, double spacing,
                                  const SpaceLayout& layout);

}  // namespace stirsph
