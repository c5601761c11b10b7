/// Where a point is on or in a mesh: the nearest point of its surface, the element around it. Points in the frame of
/// the mesh; for a moving body the caller turns them back first. For a section, any point on the circle that a place of
/// the half-plane describes stands for that place.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <vector>

#include "geometry/box_tree.hpp"
#include "geometry/mesh.hpp"

namespace stirsph {

/// A point of the surface: the sum of weights * nodes of the facet.
struct SurfacePlace {
  std::int32_t facet = -1;          ///< index into SimplexMesh::surface; -1: none within the radius
  std::array<double, 3> weights{};  ///< of its nodes; none negative, sum 1; in 2-D the third is 0
  Vec3 point;                       ///< m
  double distance = std::numeric_limits<double>::infinity();  ///< m
};

/// Copies what it needs: the mesh may go. Safe to use from several threads.
class SurfaceSearch {
 public:
  explicit SurfaceSearch(const SimplexMesh& mesh);
  SurfaceSearch(const SimplexMesh& mesh, const SurfaceGroup& group);  ///< on these facets only

  /// Exact; of equally near facets the one with the lowest index. A small radius [m] makes misses cheap.
  SurfacePlace nearest(const Vec3& place, double radius = std::numeric_limits<double>::infinity()) const;

 private:
  struct Facet {
    std::array<Vec3, 3> corners;
    std::int32_t index;
  };
  void build(const SimplexMesh& mesh, const std::vector<std::int32_t>& facets);

  int dim_;
  bool axisymmetric_;
  std::vector<Facet> facets_;
  BoxTree tree_;
};

/// A point of the volume.
struct VolumePlace {
  std::int32_t element = -1;        ///< -1: outside the mesh
  std::array<double, 4> weights{};  ///< of its nodes; sum 1; in 2-D the fourth is 0
};

/// Copies what it needs. Safe to use from several threads.
class ElementSearch {
 public:
  explicit ElementSearch(const SimplexMesh& mesh);
  /// The element that holds the point; one of them where several touch. Rounding counts as inside.
  VolumePlace find(const Vec3& place) const;

 private:
  int corners_;
  bool axisymmetric_;
  std::vector<std::array<Vec3, 4>> gradients_;
  std::vector<Vec3> first_nodes_;
  BoxTree tree_;
};

}  // namespace stirsph
