#include "thermal/interface_search.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/error.hpp"
#include "particles/field_names.hpp"
#include "thermal/contact_area.hpp"
#include "thermal/ring.hpp"

namespace stirsph {
namespace {

/// Rigid bodies are in the periodic box once: what lies outside it meets them where its image inside does.
Vec3 into_box(const Domain& domain, const SpaceLayout& layout, Vec3 x) {
  for (int d = 0; d < layout.dim; ++d) x[layout.axes[d]] = domain.wrap(x[layout.axes[d]], d);
  return x;
}

/// Feet of owned particles first, then those of halo copies; both in storage order. Without those of mirror images at
/// an axis.
std::vector<SurfaceFoot> feet_on(const ParticleSet& particles, const HeatInterface& interface, const RigidBody& rigid,
                                 const Domain& domain, double spacing) {
  const auto body = particles[field::body];
  std::vector<SurfaceFoot> feet;
  for (std::size_t i = 0; i < particles.total(); ++i) {
    if (!interface.bodies[static_cast<std::size_t>(body[i])]) continue;
    const Vec3 x = particles.vector_at(field::position, i);
    if (particles.layout().axisymmetric() && is_mirror_image(x.x)) continue;
    const SurfacePoint surface = rigid.nearest(into_box(domain, particles.layout(), x));
    if (surface.distance >= contact_reach * spacing) continue;
    feet.push_back(
        {static_cast<std::int32_t>(i), x - surface.distance * surface.normal, surface.normal, surface.distance});
  }
  return feet;
}

std::vector<NodeWeight> nodes_at(const HeatMesh& mesh, const SurfacePlace& place) {
  std::vector<NodeWeight> nodes;
  for (int c = 0; c < mesh.mesh().dim; ++c) nodes.push_back({mesh.mesh().surface[place.facet][c], place.weights[c]});
  return nodes;
}

double longest_edge(const SimplexMesh& mesh, std::int32_t facet) {
  double longest = 0;
  for (int i = 0; i < mesh.dim; ++i)
    for (int j = 0; j < i; ++j)
      longest = std::max(longest, norm(mesh.nodes[mesh.surface[facet][i]] - mesh.nodes[mesh.surface[facet][j]]));
  return longest;
}

/// A facet of edge s on a radius R >= s lies at most s/8 off the true surface; twice that is not the same surface.
double largest_gap(const SimplexMesh& mesh, const SurfacePlace& place) {
  return 0.25 * longest_edge(mesh, place.facet);
}

std::string shown(const Vec3& x) { return fmt::format("({:.5g}, {:.5g}, {:.5g}) mm", 1e3 * x.x, 1e3 * x.y, 1e3 * x.z); }

/// The friction heat of one interface: taken from the field by the points, the rest is left over.
class FrictionHeat {
 public:
  FrictionHeat(ParticleSet& particles, int component, double elapsed) : owned_(particles.owned()), elapsed_(elapsed) {
    if (component < 0) return;
    if (particles.has(field::rigid_heat)) heat_ = particles.component(field::rigid_heat, component);
    if (particles.has(field::rigid_impulse)) impulse_ = particles.component(field::rigid_impulse, component);
  }
  double take(std::size_t i) { return heat_.empty() ? 0.0 : std::exchange(heat_[i], 0.0); }
  double pressure(std::size_t i, double area) const {
    return impulse_.empty() || !(elapsed_ > 0) || !(area > 0) ? 0.0 : impulse_[i] / (elapsed_ * area);
  }
  template <class Visit>
  void for_each_left(Visit&& visit) {
    if (!heat_.empty())
      for (std::size_t i = 0; i < owned_; ++i)
        if (heat_[i] != 0) visit(i);
  }
  void clear_impulse() { std::fill(impulse_.begin(), impulse_.end(), 0.0); }

 private:
  std::size_t owned_;
  double elapsed_;
  std::span<double> heat_, impulse_;
};

void add_hybrid_points(const ParticleSet& particles, const HeatInterface& interface, const RigidBody& rigid,
                       HybridInterface& hybrid, std::vector<InterfacePoint>& points) {
  const auto body = particles[field::body], volume = particles[field::volume], h = particles[field::smoothing_length];
  for (std::size_t i = 0; i < particles.owned(); ++i) {
    if (!interface.bodies[static_cast<std::size_t>(body[i])]) continue;
    const Vec3 x = particles.vector_at(field::position, i);
    const double distance = rigid.nearest(x).distance;
    if (distance >= hybrid.reach()) continue;
    InterfacePoint point = hybrid.point_at(rigid.pose.to_body(x), volume[i], h[i]);
    if (!(point.shape_factor > 0)) continue;
    point.particle = static_cast<std::int32_t>(i);
    point.body = interface.rigid;
    point.distance = distance;
    points.push_back(std::move(point));
  }
}

/// Adds a point for each part of the square that the particle covers on the surface, so many that a part is no larger
/// than the facets there. Heat that entered a finer mesh at the foot alone would meet the resistance of a point, which
/// no refinement of the mesh removes.
void add_parts_of_footprint(const InterfacePoint& whole, const Vec3& foot, const Vec3& normal, const HeatMesh& mesh,
                            const RigidPose& pose, const SpaceLayout& layout, std::vector<InterfacePoint>& points) {
  constexpr double most_parts = 4;  // per direction; the resistance left is that of a mesh as fine as a quarter spacing
  const int dim = layout.dim;
  const bool rings = layout.axisymmetric();
  const double side = dim == 3 ? std::sqrt(whole.area) : rings ? whole.area / circumference(foot.x) : whole.area;
  const SurfacePlace middle = mesh.nearest(pose.to_body(foot));
  const int parts =
      static_cast<int>(std::clamp(std::ceil(side / longest_edge(mesh.mesh(), middle.facet)), 1.0, most_parts));
  const Vec3 axis = rings ? Vec3{0, 1, 0} : std::abs(normal.z) < 0.9 ? Vec3{0, 0, 1} : Vec3{1, 0, 0};
  const Vec3 along = normalised(cross(normal, axis)), across = cross(normal, along);
  const auto offset = [&](int k) { return ((k + 0.5) / parts - 0.5) * side; };
  const int count = dim == 3 ? parts * parts : parts;
  const auto place_of = [&](int k) {
    return foot + offset(k % parts) * along + (dim == 3 ? offset(k / parts) : 0.0) * across;
  };
  // Parts farther from an axis are longer rings.
  const auto weight_of = [&](int k) { return rings && parts > 1 ? std::abs(place_of(k).x) : 1.0; };
  double weights = 0;
  for (int k = 0; k < count; ++k) weights += weight_of(k);
  for (int k = 0; k < count; ++k) {
    InterfacePoint part = whole;
    const double share = weight_of(k) / weights;
    part.area *= share;
    part.heat *= share;
    const Vec3 place = place_of(k);
    part.nodes = nodes_at(mesh, parts == 1 ? middle : mesh.nearest(pose.to_body(place)));
    points.push_back(std::move(part));
  }
}

}  // namespace

InterfaceSearch::InterfaceSearch(std::vector<HeatInterface> interfaces, std::span<const RigidBody> rigids,
                                 std::span<const RigidHeat> heat, const Domain& domain, const SpaceLayout& layout,
                                 const Kernel& kernel, double spacing, double smoothing_length)
    : interfaces_(std::move(interfaces)), domain_(domain), layout_(layout), spacing_(spacing) {
  for (const HeatInterface& interface : interfaces_)
    hybrids_.push_back(interface.hybrid ? std::make_unique<HybridInterface>(*heat[interface.rigid].mesh,
                                                                            *rigids[interface.rigid].shape, kernel,
                                                                            layout, spacing, smoothing_length)
                                        : nullptr);
}

std::vector<InterfacePoint> InterfaceSearch::take_points(ParticleSet& particles, std::span<const RigidBody> rigids,
                                                         std::span<const RigidHeat> heat, double elapsed) {
  std::vector<InterfacePoint> points;
  for (std::size_t k = 0; k < interfaces_.size(); ++k) {
    const HeatInterface& interface = interfaces_[k];
    const RigidBody& rigid = rigids[interface.rigid];
    const RigidHeat& body = heat[interface.rigid];
    FrictionHeat friction(particles, interface.component, elapsed);
    const auto add = [&](const SurfaceFoot& foot, double area) {
      InterfacePoint point;
      point.particle = foot.particle;
      point.body = interface.rigid;
      point.distance = foot.distance;
      point.area = area;
      point.pressure = friction.pressure(foot.particle, area);
      point.heat = friction.take(foot.particle);
      if (body.mesh)
        add_parts_of_footprint(point, into_box(domain_, layout_, foot.point), foot.normal, *body.mesh, rigid.pose,
                               layout_, points);
      else
        points.push_back(std::move(point));
    };
    if (hybrids_[k]) {
      add_hybrid_points(particles, interface, rigid, *hybrids_[k], points);
    } else {
      const std::vector<SurfaceFoot> feet = feet_on(particles, interface, rigid, domain_, spacing_);
      const auto owned = static_cast<std::size_t>(std::ranges::count_if(
          feet, [&](const SurfaceFoot& foot) { return std::size_t(foot.particle) < particles.owned(); }));
      const std::vector<double> areas = contact_areas(feet, owned, spacing_, layout_);
      for (std::size_t f = 0; f < owned; ++f)
        if (areas[f] > 0) add(feet[f], areas[f]);
    }
    // What the points did not take: of particles that have left the surface, and of hybrid interfaces.
    friction.for_each_left([&](std::size_t i) {
      const Vec3 x = into_box(domain_, layout_, particles.vector_at(field::position, i));
      const SurfacePoint surface = rigid.nearest(x);
      add({static_cast<std::int32_t>(i), x - surface.distance * surface.normal, surface.normal, surface.distance}, 0.0);
    });
    friction.clear_impulse();
  }
  return points;
}

std::vector<NodeWeight> nodes_around(const HeatMesh& mesh, const Vec3& point) {
  const VolumePlace inside = ElementSearch(mesh.mesh()).find(point);
  if (inside.element < 0) {
    const SurfacePlace place = mesh.nearest(point);
    if (place.distance > largest_gap(mesh.mesh(), place))
      throw InputError(
          fmt::format("{} lies outside {}, {:.4g} mm from its nearest surface point {}. Give a place inside, where it "
                      "is at the start",
                      shown(point), mesh.mesh().source, 1e3 * place.distance, shown(place.point)));
    return nodes_at(mesh, place);
  }
  std::vector<NodeWeight> nodes;
  for (int c = 0; c < mesh.mesh().corners(); ++c)
    nodes.push_back({mesh.mesh().elements[inside.element][c], inside.weights[c]});
  return nodes;
}

/// Also without contact, where nothing else notices it.
void InterfaceSearch::check_overlap(const ParticleSet& particles, const HeatInterface& interface,
                                    const RigidBody& rigid) const {
  const double allowed = 0.1 * spacing_;  // as of contact
  const auto body = particles[field::body];
  for (std::size_t i = 0; i < particles.owned(); ++i) {
    const Vec3 x = particles.vector_at(field::position, i);
    const double depth = -rigid.nearest(into_box(domain_, layout_, x)).distance;
    if (!interface.bodies[static_cast<std::size_t>(body[i])] || depth <= allowed) continue;
    throw InputError(fmt::format(
        "rigid \"{}\": it overlaps a deformable body at the start: the centre of particle {} at {} lies {:.4g} mm deep "
        "inside, allowed are {:.4g} mm. Move or shrink one of them",
        rigid.name, static_cast<std::int64_t>(particles[field::id][i]), shown(x), 1e3 * depth, 1e3 * allowed));
  }
}

void InterfaceSearch::check_fit(const ParticleSet& particles, std::span<const RigidBody> rigids,
                                std::span<const RigidHeat> heat) const {
  for (const HeatInterface& interface : interfaces_) {
    const RigidBody& rigid = rigids[interface.rigid];
    check_overlap(particles, interface, rigid);
    if (!heat[interface.rigid].mesh) continue;
    const HeatMesh& mesh = *heat[interface.rigid].mesh;
    const ElementSearch elements(mesh.mesh());
    for (std::size_t i = 0; i < particles.owned(); ++i) {
      const Vec3 x = particles.vector_at(field::position, i);
      const VolumePlace inside = elements.find(rigid.pose.to_body(x));
      if (inside.element >= 0)
        throw InputError(
            fmt::format("rigid \"{}\": particle {} at {} lies inside element {} of {}: the mesh overlaps a deformable "
                        "body. Move or "
                        "shrink one of them, or correct the scale of the mesh file",
                        rigid.name, static_cast<std::int64_t>(particles[field::id][i]), shown(x),
                        mesh.mesh().element_number(inside.element), mesh.mesh().source));
    }
    for (const SurfaceFoot& foot : feet_on(particles, interface, rigid, domain_, spacing_)) {
      const SurfacePlace place = mesh.nearest(rigid.pose.to_body(into_box(domain_, layout_, foot.point)));
      if (place.distance > largest_gap(mesh.mesh(), place))
        throw InputError(fmt::format(
            "rigid \"{}\": the shape touches a particle at {}, but the nearest facet of {} (of element {}) is {:.4g} "
            "mm "
            "away, more than a quarter of its edge: shape and mesh are not the same body. Correct shape, mesh scale or "
            "cut",
            rigid.name, shown(foot.point), mesh.mesh().source,
            mesh.mesh().element_number(mesh.mesh().surface_elements[place.facet]), 1e3 * place.distance));
    }
  }
}

}  // namespace stirsph
