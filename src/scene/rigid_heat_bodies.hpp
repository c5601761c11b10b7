/// The rigid bodies of a scene as the heat solve sees them: meshes made or read, conditions on their surfaces.
#pragma once

#include <vector>

#include "base/comm.hpp"
#include "scene/scene.hpp"
#include "thermal/interface_search.hpp"
#include "thermal/rigid_heat.hpp"

namespace stirsph {

/// One entry per rigid body. Meshes are made on one rank, checked, and alike on all. Collective. Throws InputError on
/// all ranks.
std::vector<RigidHeat> make_rigid_heat(const Comm& comm, const Scene& scene);

/// The interfaces of the bodies that take part in the heat balance.
std::vector<HeatInterface> heat_interfaces(const Scene& scene);

/// Facets of a meshed body that a surface condition applies to.
std::vector<std::int32_t> chosen_facets(const SimplexMesh& mesh, const SurfaceScene& surface);

}  // namespace stirsph
