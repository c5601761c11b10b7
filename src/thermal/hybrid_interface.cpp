#include "thermal/hybrid_interface.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "thermal/ring.hpp"

namespace stirsph {

HybridInterface::HybridInterface(const HeatMesh& mesh, const ShapeFunction& shape, const Kernel& kernel,
                                 const SpaceLayout& layout, double spacing, double smoothing_length)
    : mesh_(mesh),
      shape_(shape),
      elements_(mesh.mesh()),
      kernel_(kernel),
      layout_(layout),
      spacing_(spacing),
      smoothing_length_(smoothing_length),
      reach_(kernel_support(kernel) * smoothing_length) {}

const std::vector<NodeWeight>& HybridInterface::embedded_at(const std::array<int, 3>& site, const Vec3& place) {
  constexpr std::int64_t offset = 1 << 20;  // 21 bits per direction
  std::uint64_t key = 0;
  for (const int n : site) key = key << 21 | static_cast<std::uint64_t>(n + offset);
  const auto [found, fresh] = sites_.try_emplace(key);
  std::vector<NodeWeight>& nodes = found->second;
  if (!fresh || shape_.distance(place) >= 0) return nodes;
  const SimplexMesh& mesh = mesh_.mesh();
  if (const VolumePlace inside = elements_.find(place); inside.element >= 0) {
    for (int c = 0; c < mesh.corners(); ++c) nodes.push_back({mesh.elements[inside.element][c], inside.weights[c]});
  } else {  // between a facet and the curved surface it stands for
    const SurfacePlace outside = mesh_.nearest(place);
    for (int c = 0; c < mesh.dim; ++c) nodes.push_back({mesh.surface[outside.facet][c], outside.weights[c]});
  }
  return nodes;
}

InterfacePoint HybridInterface::point_at(const Vec3& at, double volume, double smoothing_length) {
  InterfacePoint point;
  const bool rings = layout_.axisymmetric();
  const int dim = layout_.dim;
  const Vec3 x = rings ? turned_into_half_plane(at) : at;
  if (rings) volume /= circumference(x.x);
  const double h = 0.5 * (smoothing_length + smoothing_length_);
  const double embedded_volume = std::pow(spacing_, dim);
  const auto visit_path = [&]<class K>(const K&) {
    const double reach = K::support * h;
    std::array<int, 3> low{}, high{}, site{};
    for (int d = 0; d < dim; ++d) {
      low[d] = static_cast<int>(std::floor((x[layout_.axes[d]] - reach) / spacing_));
      high[d] = static_cast<int>(std::floor((x[layout_.axes[d]] + reach) / spacing_));
    }
    for (site[0] = low[0]; site[0] <= high[0]; ++site[0])
      for (site[1] = low[1]; site[1] <= high[1]; ++site[1])
        for (site[2] = low[2]; site[2] <= high[2]; ++site[2]) {
          Vec3 place;
          for (int d = 0; d < dim; ++d) place[layout_.axes[d]] = (site[d] + 0.5) * spacing_;
          const double r = norm(place - x);
          if (!(r < reach) || !(r > 0)) continue;
          const std::vector<NodeWeight>& nodes = embedded_at(site, place);
          if (nodes.empty()) continue;
          point.kernel_sum += embedded_volume * kernel_value<K>(r, h, dim);
          if (rings && is_mirror_image(place.x)) continue;  // no heat crosses the axis
          const double length = rings ? circumference(0.5 * (x.x + place.x)) : 1.0;
          const double factor = -2 * length * volume * embedded_volume * kernel_slope<K>(r, h, dim) / r;
          point.shape_factor += factor;
          for (const NodeWeight& node : nodes) point.nodes.push_back({node.node, factor * node.weight});
        }
  };
  std::visit(visit_path, kernel_);
  std::stable_sort(point.nodes.begin(), point.nodes.end(),
                   [](const NodeWeight& a, const NodeWeight& b) { return a.node < b.node; });
  std::size_t kept = 0;
  for (const NodeWeight& node : point.nodes)
    if (kept > 0 && point.nodes[kept - 1].node == node.node)
      point.nodes[kept - 1].weight += node.weight;
    else
      point.nodes[kept++] = node;
  point.nodes.resize(kept);
  for (NodeWeight& node : point.nodes) node.weight /= point.shape_factor;
  return point;
}

}  // namespace stirsph
