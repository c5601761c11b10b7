/// Meshes of rigid bodies for heat conduction: linear tetrahedra, triangles in the plane z = 0, or, of bodies round
/// about the z axis, triangles in their section with the half-plane y = 0, x >= 0. SI units, in the frame of the body.
/// Volumes of plane triangles are areas [m2], that is, per metre of depth, and their surface areas lengths [m]; those
/// of a section are the volumes [m3] and areas [m2] of the rings. The axis is no part of the surface.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "geometry/shape.hpp"

namespace stirsph {

/// The point of the half-plane y = 0, x >= 0 on the same circle about the z axis.
inline Vec3 turned_into_half_plane(const Vec3& x) { return {std::hypot(x.x, x.y), 0, x.z}; }

/// A named part of a surface.
struct SurfaceGroup {
  std::string name;
  std::vector<std::int32_t> facets;  ///< indices into SimplexMesh::surface, ascending
};

struct SimplexMesh {
  int dim = 3;
  bool axisymmetric = false;                          ///< a section (r, 0, z) with dim = 2
  std::vector<Vec3> nodes;                            ///< m
  std::vector<std::array<std::int32_t, 4>> elements;  ///< nodes, positively oriented; dim + 1 used, the rest -1
  /// The boundary, outward: triangles counter-clockwise seen from outside; in 2-D edges with the solid on their left.
  std::vector<std::array<std::int32_t, 3>> surface;  ///< nodes; dim used, the rest -1
  std::vector<std::int32_t> surface_elements;        ///< the element behind each facet
  std::vector<SurfaceGroup> groups;

  std::string source = "mesh";                ///< stands in messages: a file's name or a shape's description
  std::vector<std::int64_t> node_numbers;     ///< as numbered in the source; empty: index + 1
  std::vector<std::int64_t> element_numbers;  ///< as numbered in the source; empty: index + 1

  int corners() const { return dim + 1; }  ///< nodes of an element
  /// Direction that stands for the y of a plane mesh.
  int second_axis() const { return axisymmetric ? 2 : 1; }
  std::int64_t node_number(std::int32_t node) const { return node_numbers.empty() ? node + 1 : node_numbers[node]; }
  std::int64_t element_number(std::int32_t element) const {
    return element_numbers.empty() ? element + 1 : element_numbers[element];
  }
};

/// Negative when the element is inverted [m3; m2 in the plane].
double element_volume(const SimplexMesh& mesh, std::int32_t element);

/// The integrals of the nodes' linear shape functions over the element [m3; m2 in the plane]; they sum to its volume.
/// Equal shares, but in a section, where a node farther from the axis has more.
std::array<double, 4> element_shares(const SimplexMesh& mesh, std::int32_t element);

/// 6 sqrt(6) V / (longest edge * surface area), of triangles 4 sqrt(3) A / (longest edge * perimeter): 1 for the
/// regular element, 0 for a flat one, negative for an inverted one.
double element_quality(const SimplexMesh& mesh, std::int32_t element);

/// Gradients of the nodes' linear shape functions [1/m]; of triangles the fourth is zero. The element must not be flat.
std::array<Vec3, 4> shape_gradients(const SimplexMesh& mesh, std::int32_t element);

/// Outward, as long as the facet is large [m2; m in the plane].
Vec3 facet_area_vector(const SimplexMesh& mesh, std::int32_t facet);
double facet_area(const SimplexMesh& mesh, std::int32_t facet);
/// The integrals of the nodes' linear shape functions over the facet [m2; m in the plane]; they sum to its area.
std::array<double, 3> facet_shares(const SimplexMesh& mesh, std::int32_t facet);
/// The mean of the facet's nodes.
Vec3 facet_centroid(const SimplexMesh& mesh, std::int32_t facet);

double total_volume(const SimplexMesh& mesh);
double surface_area(const SimplexMesh& mesh);
Bounds mesh_bounds(const SimplexMesh& mesh);

/// Makes a section of a mesh whose nodes lie in the half-plane to rounding: puts those next to the axis on it. Throws
/// InputError for nodes elsewhere.
void lay_into_half_plane(SimplexMesh& mesh);

/// Fills surface and surface_elements from the elements, in the order of the elements; clears the groups. Throws
/// InputError when more than two elements share a face, naming them.
void extract_surface(SimplexMesh& mesh);

/// A group of the facets whose centroid and outward unit normal satisfy a condition. May be empty.
void add_group(SimplexMesh& mesh, const std::string& name,
               const std::function<bool(const Vec3& centroid, const Vec3& normal)>& belongs);

/// nullptr when there is no group of that name.
const SurfaceGroup* find_group(const SimplexMesh& mesh, const std::string& name);

/// Nodes of an edge (of triangles: of one node, twice) at which the surface does not close; nothing when it is closed.
/// A section's surface may end at the axis.
std::optional<std::array<std::int32_t, 2>> open_edge(const SimplexMesh& mesh);

}  // namespace stirsph
