/// What a mesh must be before anything is computed on it.
#pragma once

#include "geometry/mesh.hpp"

namespace stirsph {

struct MeshLimits {
  double smallest_quality = 0.02;  ///< of an element, see element_quality
  double largest_extent = 10;      ///< longest side of the bounding box [m]: beyond it the units are taken to be wrong
  double smallest_extent = 1e-5;   ///< m
};

/// Throws InputError for an empty mesh, a size that betrays wrong units, inverted or needle-like elements, parts that
/// only seem to touch (nodes twice at one place) and an open surface. The message names mesh.source and the element,
/// node or edge as numbered there.
void check_mesh(const SimplexMesh& mesh, const MeshLimits& limits = {});

}  // namespace stirsph
