#include "thermal/rigid_heat.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.hpp"

namespace stirsph {

HeatMesh::HeatMesh(SimplexMesh mesh, ThermalProperties material, double density,
                   const std::vector<SurfaceCondition>& conditions)
    : mesh_(std::move(mesh)), material_(std::move(material)), density_(density), search_(mesh_) {
  volume_.assign(nodes(), 0.0);
  film_conductance_.assign(nodes(), 0.0);
  film_source_.assign(nodes(), 0.0);
  fixed_temperature_.assign(nodes(), 0.0);
  fixed_.assign(nodes(), false);
  for (std::size_t e = 0; e < mesh_.elements.size(); ++e) {
    const auto shares = element_shares(mesh_, static_cast<std::int32_t>(e));
    for (int c = 0; c < mesh_.corners(); ++c) volume_[mesh_.elements[e][c]] += shares[c];
  }
  for (const SurfaceCondition& condition : conditions) {
    if (condition.facets.empty())
      throw InputError(fmt::format("{}: a surface condition applies to no facet of the mesh", mesh_.source));
    if (condition.kind == SurfaceCondition::Kind::Film) {
      const std::vector<double> area = lumped_area(condition.facets);
      for (std::size_t n = 0; n < nodes(); ++n) {
        film_conductance_[n] += condition.conductance * area[n];
        film_source_[n] += condition.conductance * area[n] * condition.temperature;
      }
      continue;
    }
    for (const std::int32_t facet : condition.facets)
      for (int c = 0; c < mesh_.dim; ++c) {
        const std::int32_t node = mesh_.surface[facet][c];
        if (fixed_[node] && fixed_temperature_[node] != condition.temperature)
          throw InputError(fmt::format(
              "{}: node {} at ({:.5g}, {:.5g}, {:.5g}) mm lies on two surfaces of fixed temperature, {} K and {} K. "
              "Allowed: one. Give both the same temperature, or leave facets without condition between them",
              mesh_.source, mesh_.node_number(node), 1e3 * mesh_.nodes[node].x, 1e3 * mesh_.nodes[node].y,
              1e3 * mesh_.nodes[node].z, fixed_temperature_[node], condition.temperature));
        fixed_[node] = true;
        fixed_temperature_[node] = condition.temperature;
      }
  }
}

std::vector<double> HeatMesh::lumped_area(const std::vector<std::int32_t>& facets) const {
  std::vector<double> area(nodes(), 0.0);
  for (const std::int32_t facet : facets) {
    const auto shares = facet_shares(mesh_, facet);
    for (int c = 0; c < mesh_.dim; ++c) area[mesh_.surface[facet][c]] += shares[c];
  }
  return area;
}

double RigidHeat::film(double pressure) const {
  if (!(pressure_conductance > 0) || !(pressure > 0)) return interface_conductance;
  return interface_conductance + pressure_conductance * std::pow(pressure / reference_pressure, pressure_exponent);
}

void RigidHeat::start_at(double value) {
  temperature = value;
  if (!mesh) return;
  node_temperature.assign(mesh->nodes(), value);
  for (std::size_t n = 0; n < mesh->nodes(); ++n)
    if (mesh->fixed(n)) node_temperature[n] = mesh->fixed_temperature(n);
}

}  // namespace stirsph
