#include "scene/rigid_heat_bodies.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "geometry/mesh_check.hpp"
#include "geometry/mesh_file.hpp"
#include "geometry/mesh_shape.hpp"
#include "input/wording.hpp"

namespace stirsph {
namespace {

std::string in_mm(const Vec3& x) { return fmt::format("({:.5g}, {:.5g}, {:.5g})", 1e3 * x.x, 1e3 * x.y, 1e3 * x.z); }

/// The longest side within the space of the scene, radii for diameters where that is a half-plane.
double longest_side(const Bounds& bounds, const SpaceLayout& layout) {
  double longest = 0;
  for (int d = 0; d < layout.dim; ++d) {
    const int axis = layout.axes[d];
    const double low = layout.axisymmetric() && d == 0 ? 0 : bounds.low[axis];
    longest = std::max(longest, bounds.high[axis] - low);
  }
  return longest;
}

/// A file in other units than `scale` says: a mesh may hold more or less than the shape that particles touch, but not a
/// hundred times as much.
void check_scale(const SimplexMesh& mesh, const ShapeFunction& shape, const SpaceLayout& layout) {
  constexpr double most = 20;  // an inch taken for a millimetre is 25
  const double in_mesh = longest_side(mesh_bounds(mesh), layout), in_shape = longest_side(shape.bounds(), layout);
  if (!std::isfinite(in_shape) || (in_mesh <= most * in_shape && in_shape <= most * in_mesh)) return;
  throw InputError(fmt::format(
      "{}: the mesh is {:.4g} m long, the shape of the body {:.4g} m. Allowed: a ratio between 1/{} and {}. mesh.scale "
      "turns the file's lengths into m: scale = 1e-3 for a file in mm, 1 for one in m",
      mesh.source, in_mesh, in_shape, most, most));
}

SimplexMesh make_mesh(const Scene& scene, const RigidScene& rigid) {
  const MeshScene& wanted = rigid.heat.mesh;
  const SpaceLayout layout = layout_of(scene.space);
  if (!wanted.file.empty()) {
    SimplexMesh mesh = read_mesh_file(wanted.file, {layout.dim, wanted.scale, wanted.body, layout.axisymmetric()});
    check_mesh(mesh);
    check_scale(mesh, *rigid.shape, layout);
    return mesh;
  }
  ShapeMeshOptions options;
  options.dimensions = layout.dim;
  options.axisymmetric = layout.axisymmetric();
  options.cut = wanted.cut;
  options.sizes.near = wanted.near;
  options.sizes.far = wanted.far;
  options.sizes.growth = wanted.growth;
  for (std::size_t b = 0; b < scene.bodies.size(); ++b)
    if (rigid.heat.bodies[b]) options.sizes.refine_at.push_back(scene.bodies[b].shape);
  SimplexMesh mesh = mesh_shape(rigid.shape, options).mesh;
  check_mesh(mesh);
  return mesh;
}

/// Everything of a mesh that the heat solve reads, from the root to all.
void broadcast_mesh(const Comm& comm, SimplexMesh& mesh) {
  std::vector<double> places;
  std::vector<std::int64_t> numbers{mesh.dim, mesh.axisymmetric, static_cast<std::int64_t>(mesh.nodes.size()),
                                    static_cast<std::int64_t>(mesh.elements.size()),
                                    static_cast<std::int64_t>(mesh.surface.size())};
  for (const Vec3& x : mesh.nodes) places.insert(places.end(), {x.x, x.y, x.z});
  for (const auto& element : mesh.elements) numbers.insert(numbers.end(), element.begin(), element.end());
  for (const auto& facet : mesh.surface) numbers.insert(numbers.end(), facet.begin(), facet.end());
  numbers.insert(numbers.end(), mesh.surface_elements.begin(), mesh.surface_elements.end());
  const bool numbered = comm.any(!mesh.element_numbers.empty());
  if (numbered) {
    numbers.insert(numbers.end(), mesh.element_numbers.begin(), mesh.element_numbers.end());
    numbers.insert(numbers.end(), mesh.node_numbers.begin(), mesh.node_numbers.end());
  }
  comm.broadcast(places);
  comm.broadcast(numbers);
  mesh.source = comm.broadcast(mesh.source);
  if (!comm.is_root()) {
    auto next = numbers.begin();
    mesh.dim = static_cast<int>(*next++);
    mesh.axisymmetric = *next++ != 0;
    mesh.nodes.resize(static_cast<std::size_t>(*next++));
    mesh.elements.resize(static_cast<std::size_t>(*next++));
    mesh.surface.resize(static_cast<std::size_t>(*next++));
    for (std::size_t n = 0; n < mesh.nodes.size(); ++n)
      mesh.nodes[n] = {places[3 * n], places[3 * n + 1], places[3 * n + 2]};
    const auto take = [&](auto& values) {
      for (auto& value : values) value = static_cast<std::int32_t>(*next++);
    };
    for (auto& element : mesh.elements) take(element);
    for (auto& facet : mesh.surface) take(facet);
    mesh.surface_elements.resize(mesh.surface.size());
    take(mesh.surface_elements);
    if (numbered) {
      mesh.element_numbers.assign(next, next + static_cast<std::ptrdiff_t>(mesh.elements.size()));
      next += static_cast<std::ptrdiff_t>(mesh.elements.size());
      mesh.node_numbers.assign(next, numbers.end());
    }
  }
  std::int64_t groups = static_cast<std::int64_t>(mesh.groups.size());
  std::vector<std::int64_t> count{groups};
  comm.broadcast(count);
  mesh.groups.resize(static_cast<std::size_t>(count[0]));
  for (SurfaceGroup& group : mesh.groups) {
    group.name = comm.broadcast(group.name);
    std::vector<std::int64_t> facets(group.facets.begin(), group.facets.end());
    comm.broadcast(facets);
    group.facets.assign(facets.begin(), facets.end());
  }
}

/// Those the heat solve keeps. The facets of a flux are looked for as well: a mistake must not wait for the first step.
std::vector<SurfaceCondition> surface_conditions(const SimplexMesh& mesh, const std::vector<SurfaceScene>& surfaces) {
  std::vector<SurfaceCondition> conditions;
  for (std::size_t k = 0; k < surfaces.size(); ++k) {
    const SurfaceScene& surface = surfaces[k];
    std::vector<std::int32_t> facets;
    try {
      facets = chosen_facets(mesh, surface);
    } catch (const InputError& error) {
      throw InputError(fmt::format("surface[{}]: {}", k, error.what()));
    }
    if (surface.kind == SurfaceScene::Kind::Flux) continue;
    conditions.push_back({surface.kind == SurfaceScene::Kind::FixedTemperature
                              ? SurfaceCondition::Kind::FixedTemperature
                              : SurfaceCondition::Kind::Film,
                          std::move(facets), surface.temperature, surface.conductance});
  }
  return conditions;
}

RigidHeat meshed(const Comm& comm, const Scene& scene, const RigidScene& rigid) {
  SimplexMesh mesh;
  comm.together([&] {
    if (comm.is_root()) mesh = make_mesh(scene, rigid);
  });
  broadcast_mesh(comm, mesh);
  const std::vector<SurfaceCondition> conditions = surface_conditions(mesh, rigid.heat.surfaces);
  const Material& material = scene.materials[rigid.material];
  RigidHeat heat;
  heat.mesh = std::make_shared<const HeatMesh>(std::move(mesh), material.thermal, material.density, conditions);
  heat.start_at(293.15);
  double capacity = 0, sum = 0;
  for (std::size_t n = 0; n < heat.mesh->nodes(); ++n) {
    const Vec3& x = heat.mesh->mesh().nodes[n];
    if (!heat.mesh->fixed(n)) heat.node_temperature[n] = rigid.heat.temperature({x.x, x.y, x.z});
    if (!(heat.node_temperature[n] > 0))
      throw InputError(fmt::format("the temperature is {} K at x, y, z = {}, {}, {} m. Allowed: > 0 K",
                                   heat.node_temperature[n], x.x, x.y, x.z));
    const double c = heat.mesh->node_mass(n) * material.thermal.specific_heat(heat.node_temperature[n]);
    capacity += c;
    sum += c * heat.node_temperature[n];
  }
  heat.temperature = sum / capacity;
  heat.heat_capacity = capacity;
  return heat;
}

}  // namespace

std::vector<std::int32_t> chosen_facets(const SimplexMesh& mesh, const SurfaceScene& surface) {
  if (!surface.group.empty()) {
    if (const SurfaceGroup* group = find_group(mesh, surface.group)) return group->facets;
    std::vector<std::string> known;
    for (const SurfaceGroup& group : mesh.groups) known.push_back(group.name);
    throw InputError(fmt::format("{} has no surface group \"{}\". Known: {}.{}", mesh.source, surface.group,
                                 known.empty()
                                     ? "none: name physical surfaces of the body in the mesher, or give a region"
                                     : input::joined(known),
                                 input::did_you_mean(surface.group, known)));
  }
  std::vector<std::int32_t> facets;
  for (std::size_t f = 0; f < mesh.surface.size(); ++f)
    if (surface.region->distance(facet_centroid(mesh, static_cast<std::int32_t>(f))) <= 0)
      facets.push_back(static_cast<std::int32_t>(f));
  if (facets.empty())
    throw InputError(fmt::format(
        "no facet of {} has its centroid inside the region, {}. The surface lies between {} and {} mm: move "
        "the region, or let it reach a little beyond the surface",
        mesh.source, surface.region->describe(), in_mm(mesh_bounds(mesh).low), in_mm(mesh_bounds(mesh).high)));
  return facets;
}

std::vector<RigidHeat> make_rigid_heat(const Comm& comm, const Scene& scene) {
  using Role = RigidHeatScene::Role;
  std::vector<RigidHeat> result;
  for (const RigidScene& rigid : scene.rigids) {
    const RigidHeatScene& wanted = rigid.heat;
    RigidHeat heat;
    try {
      if (scene.heat.mode != HeatScene::Mode::Conduction) {
        // Without conduction nobody exchanges heat.
      } else if (wanted.role == Role::Mesh) {
        heat = meshed(comm, scene, rigid);
        heat.role = RigidHeat::Role::Mesh;
      } else if (wanted.role != Role::Insulated) {
        heat.role = wanted.role == Role::Fixed ? RigidHeat::Role::FixedTemperature : RigidHeat::Role::LumpedNode;
        heat.temperature = wanted.temperature({0, 0, 0});
      }
    } catch (const Error& error) {
      throw Error(error.code(), scene.path + " rigid \"" + rigid.name + "\" heat: " + error.what());
    }
    if (!heat.mesh) heat.heat_capacity = wanted.heat_capacity;
    heat.ambient_conductance = wanted.ambient_conductance;
    heat.ambient_temperature = wanted.ambient_temperature;
    heat.interface_conductance = wanted.conductance;
    heat.pressure_conductance = wanted.pressure_conductance;
    heat.reference_pressure = wanted.reference_pressure;
    heat.pressure_exponent = wanted.pressure_exponent;
    result.push_back(std::move(heat));
  }
  return result;
}

std::vector<HeatInterface> heat_interfaces(const Scene& scene) {
  std::vector<HeatInterface> interfaces;
  for (std::size_t r = 0; r < scene.rigids.size(); ++r) {
    if (scene.rigids[r].heat.role == RigidHeatScene::Role::Insulated) continue;
    const int component = static_cast<int>(interfaces.size());
    const RigidHeatScene& heat = scene.rigids[r].heat;
    interfaces.push_back(
        {static_cast<int>(r), heat.bodies, heat.interface == RigidHeatScene::Interface::Hybrid, component});
  }
  return interfaces;
}

}  // namespace stirsph
