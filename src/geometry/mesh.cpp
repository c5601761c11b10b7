#include "geometry/mesh.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include <fmt/format.h>

#include "base/error.hpp"

namespace stirsph {
namespace {

/// Corners of the faces, ordered so that their normals point out of a positively oriented element.
constexpr int tetrahedron_faces[4][3] = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}};
constexpr int triangle_edges[3][2] = {{0, 1}, {1, 2}, {2, 0}};

struct Face {
  std::array<std::int32_t, 3> key;  ///< nodes in ascending order
  std::int32_t element, local;
  friend bool operator<(const Face& a, const Face& b) { return a.key != b.key ? a.key < b.key : a.element < b.element; }
};

std::array<std::int32_t, 3> face_nodes(const SimplexMesh& mesh, std::int32_t element, int local) {
  const auto& e = mesh.elements[element];
  if (mesh.dim == 2) return {e[triangle_edges[local][0]], e[triangle_edges[local][1]], -1};
  const auto& f = tetrahedron_faces[local];
  return {e[f[0]], e[f[1]], e[f[2]]};
}

/// Negative when the element is inverted [m^dim].
double element_measure(const SimplexMesh& mesh, std::int32_t element) {
  const auto& e = mesh.elements[element];
  const Vec3 &o = mesh.nodes[e[0]], a = mesh.nodes[e[1]] - o, b = mesh.nodes[e[2]] - o;
  const int v = mesh.second_axis();
  if (mesh.dim == 2) return 0.5 * (a.x * b[v] - a[v] * b.x);
  return dot(cross(a, b), mesh.nodes[e[3]] - o) / 6;
}

/// Length of the circle [m] that the mean of some nodes of a section describes; 1 for other meshes.
template <class Nodes>
double mean_circumference(const SimplexMesh& mesh, const Nodes& nodes, int count) {
  if (!mesh.axisymmetric) return 1;
  double sum = 0;
  for (int i = 0; i < count; ++i) sum += mesh.nodes[nodes[i]].x;
  return 2 * std::numbers::pi * sum / count;
}

/// Shares of the nodes of a simplex in the integral over it: of 2 pi r N_a, with r linear, the mean radius and the
/// node's own radius count, measure * 2 pi (sum of r + r_a) / (count (count + 1)).
template <class Shares, class Nodes>
Shares shares_of(const SimplexMesh& mesh, const Nodes& nodes, int count, double measure) {
  Shares shares{};
  const double mean = mean_circumference(mesh, nodes, count);
  for (int i = 0; i < count; ++i) {
    const double own = mesh.axisymmetric ? 2 * std::numbers::pi * mesh.nodes[nodes[i]].x : 1.0;
    shares[i] = measure * (count * mean + own) / (count * (count + 1));
  }
  return shares;
}

/// Outward, as long as the facet is large in its plane.
Vec3 facet_normal(const SimplexMesh& mesh, std::int32_t facet) {
  const auto& f = mesh.surface[facet];
  const Vec3 &o = mesh.nodes[f[0]], along = mesh.nodes[f[1]] - o;
  if (mesh.dim == 3) return 0.5 * cross(along, mesh.nodes[f[2]] - o);
  Vec3 normal;
  normal.x = along[mesh.second_axis()];
  normal[mesh.second_axis()] = -along.x;
  return normal;
}

}  // namespace

double element_volume(const SimplexMesh& mesh, std::int32_t element) {
  return element_measure(mesh, element) * mean_circumference(mesh, mesh.elements[element], mesh.corners());
}

std::array<double, 4> element_shares(const SimplexMesh& mesh, std::int32_t element) {
  return shares_of<std::array<double, 4>>(mesh, mesh.elements[element], mesh.corners(), element_measure(mesh, element));
}

std::array<double, 3> facet_shares(const SimplexMesh& mesh, std::int32_t facet) {
  return shares_of<std::array<double, 3>>(mesh, mesh.surface[facet], mesh.dim, norm(facet_normal(mesh, facet)));
}

double element_quality(const SimplexMesh& mesh, std::int32_t element) {
  const auto& e = mesh.elements[element];
  double longest = 0, around = 0;
  for (int i = 0; i < mesh.corners(); ++i)
    for (int j = 0; j < i; ++j) {
      const double length = norm(mesh.nodes[e[i]] - mesh.nodes[e[j]]);
      longest = std::max(longest, length);
      if (mesh.dim == 2) around += length;
    }
  if (mesh.dim == 3)
    for (int local = 0; local < 4; ++local) {
      const auto f = face_nodes(mesh, element, local);
      const Vec3& o = mesh.nodes[f[0]];
      around += 0.5 * norm(cross(mesh.nodes[f[1]] - o, mesh.nodes[f[2]] - o));
    }
  if (!(longest * around > 0)) return 0;
  const double regular = mesh.dim == 2 ? 4 * std::sqrt(3.0) : 6 * std::sqrt(6.0);
  return regular * element_measure(mesh, element) / (longest * around);
}

std::array<Vec3, 4> shape_gradients(const SimplexMesh& mesh, std::int32_t element) {
  const auto& e = mesh.elements[element];
  const Vec3 &o = mesh.nodes[e[0]], a = mesh.nodes[e[1]] - o, b = mesh.nodes[e[2]] - o;
  std::array<Vec3, 4> gradients{};
  if (mesh.dim == 2) {
    const int v = mesh.second_axis();
    const double twice = a.x * b[v] - a[v] * b.x;
    gradients[1].x = b[v] / twice;
    gradients[1][v] = -b.x / twice;
    gradients[2].x = -a[v] / twice;
    gradients[2][v] = a.x / twice;
  } else {
    const Vec3 c = mesh.nodes[e[3]] - o;
    const double six_volumes = dot(cross(a, b), c);
    gradients[1] = cross(b, c) / six_volumes;
    gradients[2] = cross(c, a) / six_volumes;
    gradients[3] = cross(a, b) / six_volumes;
  }
  gradients[0] = -(gradients[1] + gradients[2] + gradients[3]);
  return gradients;
}

Vec3 facet_area_vector(const SimplexMesh& mesh, std::int32_t facet) {
  return mean_circumference(mesh, mesh.surface[facet], mesh.dim) * facet_normal(mesh, facet);
}

double facet_area(const SimplexMesh& mesh, std::int32_t facet) { return norm(facet_area_vector(mesh, facet)); }

Vec3 facet_centroid(const SimplexMesh& mesh, std::int32_t facet) {
  Vec3 sum;
  for (int i = 0; i < mesh.dim; ++i) sum += mesh.nodes[mesh.surface[facet][i]];
  return sum / mesh.dim;
}

double total_volume(const SimplexMesh& mesh) {
  double sum = 0;
  for (std::size_t e = 0; e < mesh.elements.size(); ++e) sum += element_volume(mesh, e);
  return sum;
}

double surface_area(const SimplexMesh& mesh) {
  double sum = 0;
  for (std::size_t f = 0; f < mesh.surface.size(); ++f) sum += facet_area(mesh, f);
  return sum;
}

Bounds mesh_bounds(const SimplexMesh& mesh) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  Bounds result{{infinity, infinity, infinity}, {-infinity, -infinity, -infinity}};
  for (const Vec3& node : mesh.nodes)
    for (int i = 0; i < 3; ++i) {
      result.low[i] = std::min(result.low[i], node[i]);
      result.high[i] = std::max(result.high[i], node[i]);
    }
  return result;
}

void lay_into_half_plane(SimplexMesh& mesh) {
  double largest = 0;
  for (const Vec3& node : mesh.nodes) largest = std::max(largest, std::abs(node.x));
  const double rounding = 1e-7 * largest;  // of files with seven digits, and of Gmsh's solids
  for (std::size_t n = 0; n < mesh.nodes.size(); ++n) {
    Vec3& node = mesh.nodes[n];
    if (node.x < -rounding || std::abs(node.y) > rounding)
      throw InputError(
          fmt::format("{}: node {} lies at ({:.6g}, {:.6g}, {:.6g}) m. In the axisymmetric space a mesh is "
                      "the section of the body with the half-plane y = 0, x >= 0: x is the radius and z "
                      "the axis. Mesh that section with triangles, and turn it there",
                      mesh.source, mesh.node_number(static_cast<std::int32_t>(n)), node.x, node.y, node.z));
    node.y = 0;
    if (std::abs(node.x) <= rounding) node.x = 0;
  }
  mesh.axisymmetric = true;
}

void extract_surface(SimplexMesh& mesh) {
  std::vector<Face> faces;
  faces.reserve(mesh.elements.size() * mesh.corners());
  for (std::size_t e = 0; e < mesh.elements.size(); ++e)
    for (int local = 0; local < mesh.corners(); ++local) {
      auto key = face_nodes(mesh, e, local);
      std::sort(key.begin(), key.end());
      faces.push_back({key, static_cast<std::int32_t>(e), local});
    }
  std::sort(faces.begin(), faces.end());
  std::vector<Face> boundary;
  for (std::size_t i = 0, next; i < faces.size(); i = next) {
    for (next = i + 1; next < faces.size() && faces[next].key == faces[i].key;) ++next;
    if (next - i > 2)
      throw InputError(fmt::format("{}: elements {}, {} and {} share one {}: elements overlap", mesh.source,
                                   mesh.element_number(faces[i].element), mesh.element_number(faces[i + 1].element),
                                   mesh.element_number(faces[i + 2].element), mesh.dim == 2 ? "edge" : "face"));
    if (next - i == 1) boundary.push_back(faces[i]);
  }
  std::sort(boundary.begin(), boundary.end(), [](const Face& a, const Face& b) {
    return a.element != b.element ? a.element < b.element : a.local < b.local;
  });
  mesh.surface.clear();
  mesh.surface_elements.clear();
  mesh.groups.clear();
  for (const Face& face : boundary) {
    const auto nodes = face_nodes(mesh, face.element, face.local);
    if (mesh.axisymmetric && mesh.nodes[nodes[0]].x == 0 && mesh.nodes[nodes[1]].x == 0) continue;  // on the axis
    mesh.surface.push_back(nodes);
    mesh.surface_elements.push_back(face.element);
  }
}

void add_group(SimplexMesh& mesh, const std::string& name,
               const std::function<bool(const Vec3& centroid, const Vec3& normal)>& belongs) {
  SurfaceGroup group{name, {}};
  for (std::size_t f = 0; f < mesh.surface.size(); ++f)
    if (belongs(facet_centroid(mesh, f), normalised(facet_area_vector(mesh, f)))) group.facets.push_back(f);
  mesh.groups.push_back(std::move(group));
}

const SurfaceGroup* find_group(const SimplexMesh& mesh, const std::string& name) {
  for (const auto& group : mesh.groups)
    if (group.name == name) return &group;
  return nullptr;
}

std::optional<std::array<std::int32_t, 2>> open_edge(const SimplexMesh& mesh) {
  if (mesh.dim == 2) {
    std::vector<int> balance(mesh.nodes.size());  // edges that begin at a node less those that end there
    for (const auto& edge : mesh.surface) ++balance[edge[0]], --balance[edge[1]];
    for (const auto& edge : mesh.surface)
      for (const auto node : {edge[0], edge[1]})
        if (balance[node] != 0 && !(mesh.axisymmetric && mesh.nodes[node].x == 0)) return std::array{node, node};
    return std::nullopt;
  }
  // Each edge must be run through as often one way as the other; where solids touch in an edge that is twice each.
  struct Side {
    std::array<std::int32_t, 2> edge;
    int direction;
  };
  std::vector<Side> sides;
  sides.reserve(3 * mesh.surface.size());
  for (const auto& f : mesh.surface)
    for (int i = 0; i < 3; ++i) {
      const auto from = f[i], to = f[(i + 1) % 3];
      sides.push_back({{std::min(from, to), std::max(from, to)}, from < to ? 1 : -1});
    }
  std::sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) { return a.edge < b.edge; });
  for (std::size_t i = 0; i < sides.size();) {
    const auto edge = sides[i].edge;
    int balance = 0;
    for (; i < sides.size() && sides[i].edge == edge; ++i) balance += sides[i].direction;
    if (balance != 0) return edge;
  }
  return std::nullopt;
}

}  // namespace stirsph
