#include "geometry/mesh_check.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <fmt/format.h>

#include "base/error.hpp"

namespace stirsph {
namespace {

[[noreturn]] void refuse(const SimplexMesh& mesh, const std::string& what) {
  throw InputError(fmt::format("{}: {}", mesh.source, what));
}

std::string shown(const Vec3& v) { return fmt::format("({:.6g}, {:.6g}, {:.6g}) m", v.x, v.y, v.z); }

std::string named(const SimplexMesh& mesh, std::int32_t element) {
  std::string nodes;
  for (int i = 0; i < mesh.corners(); ++i)
    nodes += fmt::format("{}{}", i ? ", " : "", mesh.node_number(mesh.elements[element][i]));
  return fmt::format("element {} (nodes {}; first node at {})", mesh.element_number(element), nodes,
                     shown(mesh.nodes[mesh.elements[element][0]]));
}

void check_indices(const SimplexMesh& mesh) {
  if (mesh.elements.empty() || mesh.nodes.empty())
    refuse(mesh, fmt::format("the mesh is empty: it holds no {}. A surface alone is not enough: mesh the solid, in "
                             "Gmsh with gmsh -{}",
                             mesh.dim == 2 ? "triangles" : "tetrahedra", mesh.dim));
  const auto count = static_cast<std::int32_t>(mesh.nodes.size());
  for (std::size_t e = 0; e < mesh.elements.size(); ++e)
    for (int i = 0; i < mesh.corners(); ++i)
      if (mesh.elements[e][i] < 0 || mesh.elements[e][i] >= count)
        refuse(mesh, fmt::format("element {} names a node that does not exist", mesh.element_number(e)));
  for (std::int32_t n = 0; n < count; ++n)
    if (!std::isfinite(norm(mesh.nodes[n]))) refuse(mesh, fmt::format("node {} is nowhere", mesh.node_number(n)));
}

void check_units(const SimplexMesh& mesh, const MeshLimits& limits) {
  const Bounds bounds = mesh_bounds(mesh);
  double extent = 0;
  for (int i = 0; i < 3; ++i) extent = std::max(extent, bounds.high[i] - bounds.low[i]);
  if (extent > limits.largest_extent)
    refuse(mesh, fmt::format("the mesh is {:.4g} m long: is the file in mm? give scale = 1e-3", extent));
  if (extent < limits.smallest_extent)
    refuse(mesh,
           fmt::format("the mesh is only {:.4g} m long: scale turns the file's lengths into m; is the file in mm? "
                       "give scale = 1e-3; is it in m? give scale = 1",
                       extent));
}

void check_elements(const SimplexMesh& mesh, const MeshLimits& limits) {
  std::int32_t worst = 0, bad = 0;
  double lowest = 2;
  for (std::size_t e = 0; e < mesh.elements.size(); ++e) {
    const double quality = element_quality(mesh, e);
    if (!(quality >= limits.smallest_quality)) ++bad;
    if (!(quality >= lowest)) {
      lowest = quality;
      worst = static_cast<std::int32_t>(e);
    }
  }
  if (bad == 0) return;
  const std::string others = bad > 1 ? fmt::format("; {} more elements are below the limit", bad - 1) : "";
  if (lowest <= 0)
    refuse(mesh, fmt::format(
                     "{} is inverted or flat: volume {:.3g} m{}, quality {:.3g}, allowed from {:.3g}{}. Mesh it again",
                     named(mesh, worst), element_volume(mesh, worst), mesh.axisymmetric ? 3 : mesh.dim, lowest,
                     limits.smallest_quality, others));
  refuse(mesh, fmt::format("{} is a needle or sliver: quality {:.3g}, allowed from {:.3g} (1 is regular){}. Mesh it "
                           "again, finer or with the mesher's optimisation on",
                           named(mesh, worst), lowest, limits.smallest_quality, others));
}

void check_double_nodes(const SimplexMesh& mesh) {
  const Bounds bounds = mesh_bounds(mesh);
  // Files written with seven digits round the same place differently; no good element is that small.
  const double together = 1e-6 * norm(bounds.high - bounds.low);
  // Sorted along a direction in which no mesh is aligned: then only nodes really close are neighbours.
  const Vec3 direction = normalised(Vec3{1, 0.6180339887, 0.4142135624});
  std::vector<double> place(mesh.nodes.size());
  for (std::size_t n = 0; n < place.size(); ++n) place[n] = dot(mesh.nodes[n], direction);
  std::vector<std::int32_t> order(place.size());
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(), [&](auto a, auto b) { return place[a] < place[b]; });
  for (std::size_t i = 0; i < order.size(); ++i)
    for (std::size_t j = i + 1; j < order.size() && place[order[j]] - place[order[i]] <= together; ++j)
      if (norm(mesh.nodes[order[i]] - mesh.nodes[order[j]]) <= together)
        refuse(mesh,
               fmt::format("nodes {} and {} are both at {}: no heat would flow between the parts there; mesh them "
                           "with common nodes",
                           mesh.node_number(std::min(order[i], order[j])),
                           mesh.node_number(std::max(order[i], order[j])), shown(mesh.nodes[order[i]])));
}

void check_closed(const SimplexMesh& mesh) {
  if (mesh.surface.empty()) refuse(mesh, "the mesh has no surface");
  const auto edge = open_edge(mesh);
  if (!edge) return;
  const auto [a, b] = *edge;
  if (mesh.dim == 2)
    refuse(mesh, fmt::format("the outline is open at node {}, {}", mesh.node_number(a), shown(mesh.nodes[a])));
  refuse(mesh, fmt::format("the surface is open at the edge between nodes {} and {}, from {} to {}",
                           mesh.node_number(a), mesh.node_number(b), shown(mesh.nodes[a]), shown(mesh.nodes[b])));
}

}  // namespace

void check_mesh(const SimplexMesh& mesh, const MeshLimits& limits) {
  check_indices(mesh);
  check_units(mesh, limits);
  check_elements(mesh, limits);
  check_double_nodes(mesh);
  check_closed(mesh);
}

}  // namespace stirsph
