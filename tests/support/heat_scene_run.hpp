/// What the heat cases of the verification catalogue have in common: boxes in two and three dimensions, values of the
/// history by name, temperatures of quasi-one-dimensional bodies layer by layer.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <map>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "support/scene_run.hpp"

namespace stirsph::testing {

using Overrides = std::vector<std::string>;

inline Overrides joined(Overrides first, const Overrides& second) {
  first.insert(first.end(), second.begin(), second.end());
  return first;
}

/// "key=value unit" with all digits.
inline std::string override_of(const std::string& key, double value, const std::string& unit) {
  char text[64];
  std::snprintf(text, sizeof text, "%.15g", value);
  return key + "=" + text + (unit.empty() ? "" : " " + unit);
}

inline std::string corner(const std::string& key, const Vec3& x, int dim) {
  char text[160];
  std::snprintf(text, sizeof text,
                dim == 3 ? "=[\"%.15g m\", \"%.15g m\", \"%.15g m\"]" : "=[\"%.15g m\", \"%.15g m\"]", x.x, x.y, x.z);
  return key + text;
}

/// Sets a table with `low` and `high`, such as a box or the domain.
inline Overrides box(const std::string& key, const Vec3& low, const Vec3& high, int dim) {
  return {corner(key + ".low", low, dim), corner(key + ".high", high, dim)};
}

/// The overrides that make a scene with the periodic directions y and z one of the dimension asked for.
inline Overrides space_of(int dim) {
  return dim == 3 ? Overrides{} : Overrides{"space=plane_strain", "domain.periodic=[\"y\"]"};
}

/// Particles (body 0) from x = low to high, +-half across, in a periodic box of that size.
inline Overrides column(double low, double high, double half, int dim) {
  Overrides all = space_of(dim);
  for (const std::string key : {"domain", "body.0.shape"})
    all = joined(all, box(key, {low, -half, -half}, {high, half, half}, dim));
  return all;
}

/// Such a column from x = low to 0, and rigid body 0, a box with the same section, from there to x = high.
inline Overrides touching_columns(double low, double high, double half, int dim) {
  return joined(column(low, 0, half, dim), box("rigid.0.shape", {0, -half, -half}, {high, half, half}, dim));
}

/// A value of the history by its column's name. Collective.
inline double history_value(const Simulation& simulation, const std::string& name) {
  const auto columns = history_columns(simulation.scene());
  const auto row = history_row(simulation, diagnose(simulation));
  for (std::size_t k = 0; k < columns.size(); ++k)
    if (columns[k].name == name) return row[k];
  throw std::runtime_error("the history has no column " + name);
}

/// Values of the probes whose name begins with `prefix`. Collective.
inline std::vector<double> probe_values(const Simulation& simulation, const std::string& prefix) {
  const std::vector<double> values = diagnose(simulation).probes;
  std::vector<double> chosen;
  for (std::size_t k = 0; k < values.size(); ++k)
    if (simulation.scene().probes[k].name.starts_with(prefix)) chosen.push_back(values[k]);
  return chosen;
}

inline double mean(const std::vector<double>& values) {
  double sum = 0;
  for (const double value : values) sum += value;
  return sum / static_cast<double>(values.size());
}

/// Steps until the time is reached; the scene's fixed step divides it.
inline void run_until(Simulation& simulation, double time) {
  while (simulation.clock().time < time * (1 - 1e-9)) simulation.step();
}

/// Mean temperature of the particles of each layer across x. Collective.
inline std::map<double, double> layers(const Simulation& simulation) {
  const std::vector<double> x = gathered(simulation, field::position, 0);
  const std::vector<double> temperature = gathered(simulation, field::temperature);
  const double spacing = simulation.scene().numerics.spacing;
  std::map<long, std::array<double, 3>> sums;
  for (std::size_t i = 0; i < x.size(); ++i) {
    auto& sum = sums[std::lround(4 * x[i] / spacing)];
    sum = {sum[0] + x[i], sum[1] + temperature[i], sum[2] + 1};
  }
  std::map<double, double> result;
  for (const auto& [key, sum] : sums) result[sum[0] / sum[2]] = sum[1] / sum[2];
  return result;
}

/// Temperature of the particles at the plane x = face, from the parabola through the third to fifth layer: the first
/// two deviate from the continuum near a surface that heat crosses, see the README of thermal.
inline double face_temperature(const Simulation& simulation, double face) {
  const std::map<double, double> all = layers(simulation);
  std::vector<std::pair<double, double>> nearest(all.begin(), all.end());
  std::sort(nearest.begin(), nearest.end(),
            [&](const auto& a, const auto& b) { return std::abs(a.first - face) < std::abs(b.first - face); });
  double value = 0;
  for (int i = 2; i < 5; ++i) {
    double weight = 1;
    for (int j = 2; j < 5; ++j)
      if (j != i) weight *= (face - nearest[j].first) / (nearest[i].first - nearest[j].first);
    value += weight * nearest[i].second;
  }
  return value;
}

/// sqrt(sum (T - exact)^2 / sum exact^2) over all particles; both temperatures less `base`. Collective.
template <class Exact>
double particle_error(const Simulation& simulation, double base, Exact exact) {
  const std::vector<double> x = gathered(simulation, field::position, 0);
  const std::vector<double> temperature = gathered(simulation, field::temperature);
  double error = 0, scale = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    error += std::pow(temperature[i] - exact(x[i]), 2);
    scale += std::pow(exact(x[i]) - base, 2);
  }
  return std::sqrt(error / scale);
}

/// The same over all nodes of a rigid body's mesh, weighted with their volume.
template <class Exact>
double mesh_error(const Simulation& simulation, int rigid, double base, Exact exact) {
  const RigidHeat& body = simulation.rigid_heat()[rigid];
  double error = 0, scale = 0;
  for (std::size_t n = 0; n < body.mesh->nodes(); ++n) {
    const double there = exact(body.mesh->mesh().nodes[n].x), volume = body.mesh->node_volume(n);
    error += volume * std::pow(body.node_temperature[n] - there, 2);
    scale += volume * std::pow(there - base, 2);
  }
  return std::sqrt(error / scale);
}

/// Mean temperature of a mesh over its facets in the plane x = face.
inline double mesh_face_temperature(const Simulation& simulation, int rigid, double face) {
  const RigidHeat& body = simulation.rigid_heat()[rigid];
  const SimplexMesh& mesh = body.mesh->mesh();
  double sum = 0, area = 0;
  for (std::int32_t f = 0; f < static_cast<std::int32_t>(mesh.surface.size()); ++f) {
    double farthest = 0, temperature = 0;
    for (int k = 0; k < mesh.dim; ++k) {
      farthest = std::max(farthest, std::abs(mesh.nodes[mesh.surface[f][k]].x - face));
      temperature += body.node_temperature[mesh.surface[f][k]] / mesh.dim;
    }
    if (farthest > 1e-9) continue;
    sum += facet_area(mesh, f) * temperature;
    area += facet_area(mesh, f);
  }
  return sum / area;
}

/// Observed order from the errors at two resolutions.
inline double order(double coarse, double fine, double ratio = 2) { return std::log(coarse / fine) / std::log(ratio); }

}  // namespace stirsph::testing
