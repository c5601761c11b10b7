/// Meshes of the code's own shapes by the Gmsh library. Not thread-safe; call on one rank and broadcast.
#pragma once

#include <optional>
#include <vector>

#include "geometry/mesh.hpp"

namespace stirsph {

/// Edge length near + growth * (distance to the nearest of `refine_at`), at most far. Inside those solids: near.
struct MeshSizes {
  double near = 0;                        ///< m
  double far = 0;                         ///< m
  double growth = 0.3;                    ///< how much longer edges get per distance; at most 1 makes good elements
  std::vector<ShapePointer> refine_at{};  ///< in the frame of the body, such as the billet; empty: near everywhere
};

struct ShapeMeshOptions {
  int dimensions = 3;         ///< 2: triangles of the section at z = 0
  bool axisymmetric = false;  ///< with dimensions = 2: of the section with the half-plane y = 0, x >= 0
  MeshSizes sizes;
  /// Keeps what lies within; needed for endless shapes. Only the coordinates of the section count; its upper x is then
  /// the largest radius of a section with the half-plane.
  std::optional<Bounds> cut{};
  bool fast =
      false;  ///< about four times as fast, but a different mesh every time: such a mesh must be stored to restart
};

struct ShapeMesh {
  SimplexMesh mesh;        ///< one surface group per smooth face: "face 1", "face 2", ...
  double worst_quality;    ///< see element_quality
  double surface_gap;      ///< see surface_gap() [m]
  double meshing_seconds;  ///< wall-clock time
};

/// Nodes on curved faces lie on the exact surface. For a section with the half-plane the shape must be round about the
/// z axis. Throws InputError when the shape is empty, endless and not cut, or cannot be meshed.
ShapeMesh mesh_shape(const ShapePointer& shape, const ShapeMeshOptions& options);

/// The largest distance from the middle of a facet or of its edges to the shape's surface: s^2/(8R) for edges of length
/// s across a cylinder of radius R [m].
double surface_gap(const SimplexMesh& mesh, const ShapeFunction& shape);

}  // namespace stirsph
