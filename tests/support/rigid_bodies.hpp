/// Rigid bodies with meshes for tests of the heat solve.
#pragma once

#include <cmath>
#include <limits>
#include <memory>
#include <random>
#include <vector>

#include "geometry/mesh_check.hpp"
#include "geometry/mesh_shape.hpp"
#include "geometry/primitives.hpp"
#include "support/lattice.hpp"
#include "thermal/heat_solver.hpp"

namespace stirsph::testing {

inline constexpr double infinite = std::numeric_limits<double>::infinity(), mm = 1e-3;
inline constexpr double aluminium_k = 188, steel_k = 24.4, steel_density = 7800;

inline ThermalProperties aluminium() { return {{{aluminium_k}}, {{875}}}; }
inline ThermalProperties steel() { return {{{steel_k}}, {{460}}}; }
/// The paper's alloy, table 2; fits in kelvin.
inline ThermalProperties alloy() { return {{{7.62, 0.995, -17e-4, 1e-6}, 250, 900}, {{706.7, 0.6, -1e-4}, 250, 900}}; }

/// Unstructured mesh of a box; in 2-D of its section.
inline SimplexMesh box_mesh(const Vec3& low, const Vec3& high, double edge, int dim = 3) {
  ShapeMeshOptions options;
  options.dimensions = dim;
  options.sizes.near = options.sizes.far = edge;
  SimplexMesh mesh = mesh_shape(std::make_shared<Box>(low, high), options).mesh;
  check_mesh(mesh);
  return mesh;
}

/// Facets whose centroid lies on the plane where coordinate `axis` has this value.
inline std::vector<std::int32_t> facets_at(const SimplexMesh& mesh, int axis, double value) {
  std::vector<std::int32_t> facets;
  for (std::size_t f = 0; f < mesh.surface.size(); ++f)
    if (std::abs(facet_centroid(mesh, static_cast<std::int32_t>(f))[axis] - value) < 1e-9)
      facets.push_back(static_cast<std::int32_t>(f));
  return facets;
}

inline SurfaceCondition fixed_at(std::vector<std::int32_t> facets, double temperature) {
  return {SurfaceCondition::Kind::FixedTemperature, std::move(facets), temperature, 0};
}

inline SurfaceCondition film_at(std::vector<std::int32_t> facets, double conductance, double ambient) {
  return {SurfaceCondition::Kind::Film, std::move(facets), ambient, conductance};
}

inline RigidHeat meshed(SimplexMesh mesh, const ThermalProperties& material,
                        const std::vector<SurfaceCondition>& conditions, double temperature = 350) {
  RigidHeat heat;
  heat.role = RigidHeat::Role::Mesh;
  heat.mesh = std::make_shared<const HeatMesh>(std::move(mesh), material, steel_density, conditions);
  heat.start_at(temperature);
  return heat;
}

/// Free nodes by number, so that the ranks do not matter.
inline void randomise_nodes(RigidHeat& heat, unsigned seed = 3) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> between(300, 750);
  for (std::size_t n = 0; n < heat.mesh->nodes(); ++n)
    if (const double t = between(random); !heat.mesh->fixed(n)) heat.node_temperature[n] = t;
}

inline double enthalpy(const RigidHeat& heat) {
  double sum = 0;
  for (std::size_t n = 0; n < heat.mesh->nodes(); ++n)
    if (!heat.mesh->fixed(n))
      sum += heat.mesh->node_mass(n) * heat.mesh->material().specific_heat.integral(300, heat.node_temperature[n]);
  return sum;
}

inline HeatSettings settings_for(const Lattice& lattice, double tolerance = 1e-12) {
  HeatSettings settings;
  settings.spacing = lattice.spacing;
  settings.smoothing_length = lattice.h_over_dx * lattice.spacing;
  settings.relative_tolerance = tolerance;
  return settings;
}

inline Lattice block() {
  Lattice lattice;
  lattice.count = {12, 8, 6};
  lattice.spacing = 0.5 * mm;
  lattice.density = 2705;
  lattice.jitter = 0.1;
  return lattice;
}

}  // namespace stirsph::testing
