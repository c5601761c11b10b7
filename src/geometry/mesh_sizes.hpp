/// What a shape mesh's sizes mean, and whether they make sense, before the mesher is asked.
#pragma once

#include "geometry/mesh_shape.hpp"

namespace stirsph {

/// Throws InputError for wrong dimensions or sizes.
void check_mesh_options(const ShapeMeshOptions& options);

/// Edge length [m] wanted at a point.
double edge_length_at(const MeshSizes& sizes, const Vec3& point);

/// The part of space that is meshed [m]: the shape's bounds within the cut; z = 0 in 2-D. Throws InputError when it is
/// endless or empty.
Bounds meshed_region(const ShapeFunction& shape, const ShapeMeshOptions& options);

/// Throws InputError when the sizes ask for so many elements that a length must be in a wrong unit: it would keep the
/// mesher busy until the memory is full.
void check_element_count(const ShapeFunction& shape, const ShapeMeshOptions& options);

}  // namespace stirsph
