/// The area with which each particle faces its surroundings, for heat lost to air.
///
/// Every particle stands for its Voronoi cell. A sphere of 0.95 spacings around a particle inside a body lies behind
/// the faces of that cell; at a surface a part of it sticks out. The vector integral of n dA over that part is one
/// lattice face per exposed side; its component along the smoothed outward direction, over its value on a flat face of
/// a lattice, is the area. The gradient of the kernel sum, the usual measure, loses a spacing of face at every edge and
/// 18 % on walls of two particles, and does not vanish inside a disordered body (0.09 faces per particle at 10 %).
#pragma once

#include <span>
#include <vector>

#include "neighbours/pair_list.hpp"
#include "particles/particle_set.hpp"
#include "thermal/contact_area.hpp"

namespace stirsph {

/// Free area [m2; m in plane strain; of the ring in the axisymmetric space] of each owned particle. `feet`: of owned
/// particles on rigid surfaces of all bodies, in any order, copies ignored; what faces a rigid body nearer than
/// contact_reach is not free. Reads position and volume of halo copies; conduction_correction of owned particles, which
/// picks out the few near a surface, must be up to date.
std::vector<double> free_surface_areas(const ParticleSet& particles, const PairList& pairs,
                                       std::span<const SurfaceFoot> feet);

}  // namespace stirsph
