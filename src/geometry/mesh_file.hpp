/// Meshes in Gmsh's .msh files, versions 4.1 and 2.2, text or binary. Not thread-safe; call on one rank and broadcast.
#pragma once

#include <string>

#include "geometry/mesh.hpp"

namespace stirsph {

struct MeshFileOptions {
  int dimensions = 3;         ///< 3: tetrahedra; 2: triangles in the plane z = 0
  double scale = 1;           ///< metres per unit of length of the file
  std::string body{};         ///< name of the physical volume (2-D: surface) to read; empty: all elements
  bool axisymmetric = false;  ///< with dimensions = 2: triangles in the half-plane y = 0, x >= 0
};

/// Reads nodes and elements, extracts the surface; physical surfaces (2-D: curves) on it become surface groups, under
/// their name or, without one, their number. Does not check the mesh: see check_mesh. Throws InputError.
SimplexMesh read_mesh_file(const std::string& path, const MeshFileOptions& options = {});

enum class MeshFileFormat { Text4, Binary4, Text2, Binary2 };
/// In metres; groups become physical surfaces (a facet of several groups keeps the first only). Throws IoError.
void write_mesh_file(const SimplexMesh& mesh, const std::string& path, MeshFileFormat format = MeshFileFormat::Binary4);

}  // namespace stirsph
