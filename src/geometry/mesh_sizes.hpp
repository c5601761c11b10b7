/// What a shape mesh's sizes mean, and whether they make sense, before the mesher is asked.
#pragma once

#include <array>

#include "geometry/mesh_shape.hpp"

namespace stirsph {

/// Throws InputError for wrong dimensions or sizes.
void check_mesh_options(const ShapeMeshOptions& options);

/// Edge length [m] wanted at a point.
double edge_length_at(const MeshSizes& sizes, const Vec3& point);

/// The scene's directions in which a mesh extends; `dimensions` of them.
inline std::array<int, 3> mesh_axes(const ShapeMeshOptions& options) {
  return options.axisymmetric ? std::array{0, 2, 1} : std::array{0, 1, 2};
}

/// The part of space that is meshed [m]: the shape's bounds within the cut; in a section the third direction has no
/// width. Throws InputError when it is endless or empty.
Bounds meshed_region(const ShapeFunction& shape, const ShapeMeshOptions& options);

/// Throws InputError when the sizes ask for so many elements that a length must be in a wrong unit: it would keep the
/// mesher busy until the memory is full.
void check_element_count(const ShapeFunction& shape, const ShapeMeshOptions& options);

}  // namespace stirsph
