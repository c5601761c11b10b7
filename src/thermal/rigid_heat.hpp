/// Rigid bodies in the heat balance: insulated, at a fixed temperature, one node, or a mesh of linear elements.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "geometry/mesh.hpp"
#include "geometry/surface_search.hpp"
#include "materials/thermal_properties.hpp"

namespace stirsph {

/// A condition on some outer facets of a mesh; facets without one are insulated.
struct SurfaceCondition {
  enum class Kind { FixedTemperature, Film } kind = Kind::Film;
  std::vector<std::int32_t> facets;  ///< indices into SimplexMesh::surface
  double temperature = 293.15;       ///< K, of the surface or of the surroundings
  double conductance = 0;            ///< W/m2/K, film
};

/// A rigid body's mesh with what the heat solve needs of it. The same on all ranks; does not change.
/// Mass and surfaces are lumped to the nodes: a matrix with a diagonal capacity cannot oscillate in time under backward
/// Euler. In plane strain everything is per metre of depth, in the axisymmetric space of the whole ring.
class HeatMesh {
 public:
  /// Throws InputError when a condition has no facet or a node gets two different fixed temperatures.
  HeatMesh(SimplexMesh mesh, ThermalProperties material, double density,
           const std::vector<SurfaceCondition>& conditions = {});

  const SimplexMesh& mesh() const { return mesh_; }
  const ThermalProperties& material() const { return material_; }
  std::size_t nodes() const { return mesh_.nodes.size(); }
  double node_volume(std::size_t node) const { return volume_[node]; }  ///< m3
  double node_mass(std::size_t node) const { return density_ * volume_[node]; }
  bool fixed(std::size_t node) const { return fixed_[node]; }
  double fixed_temperature(std::size_t node) const { return fixed_temperature_[node]; }
  /// Film to the surroundings: power into the node [W] = film_source - film_conductance * T.
  double film_conductance(std::size_t node) const { return film_conductance_[node]; }  ///< W/K
  double film_source(std::size_t node) const { return film_source_[node]; }            ///< W
  /// Area of these facets that belongs to each node [m2].
  std::vector<double> lumped_area(const std::vector<std::int32_t>& facets) const;
  /// Nearest point of the surface, in the body's frame.
  SurfacePlace nearest(const Vec3& point) const { return search_.nearest(point); }

 private:
  SimplexMesh mesh_;
  ThermalProperties material_;
  double density_;  ///< kg/m3
  SurfaceSearch search_;
  std::vector<double> volume_, film_conductance_, film_source_, fixed_temperature_;
  std::vector<bool> fixed_;
};

/// How a rigid body takes part in the heat balance; temperatures are the same on all ranks.
struct RigidHeat {
  enum class Role { Insulated, FixedTemperature, LumpedNode, Mesh };
  Role role = Role::Insulated;
  double temperature = 293.15;          ///< K; of a mesh the mean weighted with the heat capacity
  double heat_capacity = 0;             ///< J/K; an input of a lumped node, for information of a mesh
  double ambient_conductance = 0;       ///< W/K from the lumped node to the surroundings
  double ambient_temperature = 293.15;  ///< K
  double interface_conductance = 0;     ///< W/m2/K of the contact with particles; infinity = perfect contact
  /// Film under pressure: interface_conductance + pressure_conductance (p/reference_pressure)^pressure_exponent.
  double pressure_conductance = 0;  ///< W/m2/K
  double reference_pressure = 1e6;  ///< Pa
  double pressure_exponent = 0.95;  ///< Cooper, Mikic, Yovanovich (1969)
  std::shared_ptr<const HeatMesh> mesh{};
  std::vector<double> node_temperature{};  ///< K, of the mesh's nodes
  std::vector<double> node_input{};  ///< J put into the mesh's nodes since the last solve, alike on all ranks; or empty

  /// Film conductance [W/m2/K] at a contact pressure [Pa].
  double film(double pressure) const;
  /// Sets the temperature of all nodes, those of fixed surfaces to their own.
  void start_at(double temperature);
};

}  // namespace stirsph
