/// Meshes of rigid bodies with the temperature of their nodes, as one grid beside the snapshot of the particles.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "base/comm.hpp"
#include "geometry/mesh.hpp"
#include "geometry/rigid_body.hpp"

namespace stirsph {

/// One meshed body at one instant. Only the root's is looked at; the other ranks may leave it empty.
struct MeshState {
  const SimplexMesh* mesh = nullptr;
  std::int64_t body = 0;            ///< its place among the rigid bodies of the scene, from 0
  std::vector<Vec3> points;         ///< m, nodes of the mesh in the frame of the scene
  std::vector<double> temperature;  ///< K, of the nodes
};

/// The nodes of a mesh [m], carried from the frame of the body to that of the scene.
std::vector<Vec3> nodes_in_scene(const SimplexMesh& mesh, const RigidPose& pose);

/// Collective. Writes all bodies as one grid of tetrahedra and triangles: PointData/temperature, CellData/body.
void write_rigid_snapshot(const Comm& comm, const std::string& path, const std::vector<MeshState>& bodies, double time,
                          std::int64_t step);

/// FOLDER/rigid_000012.vtkhdf
std::string rigid_snapshot_path(const std::string& folder, int number);

}  // namespace stirsph
