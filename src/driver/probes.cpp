#include "driver/probes.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "driver/mixing.hpp"
#include "driver/particle_values.hpp"
#include "input/wording.hpp"
#include "particles/field_names.hpp"

namespace stirsph {
namespace {

/// Whether a probe reads a particle field at all.
bool reads_field(const ProbeScene& probe) {
  using Kind = ProbeScene::Kind;
  return probe.kind != Kind::ExtrudedLength && probe.kind != Kind::AngularSpread && probe.kind != Kind::Mixing &&
         probe.rigid < 0;
}

/// Kernel interpolation with normalised weights (Shepard), so that a probe near a surface is not biased towards zero.
double at_point(const Simulation& simulation, const ProbeScene& probe) {
  const ParticleSet& particles = simulation.particles();
  const auto value = particle_value(simulation, probe.field, probe.component);
  const auto h = particles[field::smoothing_length], volume = particles[field::volume];
  const int dim = particles.layout().dim;
  double weight_sum = 0, sum = 0;
  for (std::size_t i = 0; i < particles.owned(); ++i) {
    const double r = norm(particles.vector_at(field::position, i) - probe.position);
    const double weight = std::visit(
        [&]<class K>(const K&) { return r < K::support * h[i] ? volume[i] * kernel_value<K>(r, h[i], dim) : 0.0; },
        simulation.scene().numerics.kernel);
    weight_sum += weight;
    sum += weight * value(i);
  }
  weight_sum = simulation.comm().sum(weight_sum);
  sum = simulation.comm().sum(sum);
  return weight_sum > 0 ? sum / weight_sum : std::numeric_limits<double>::quiet_NaN();
}

/// Temperature [K] at a place of a rigid body; of a body without a mesh its one temperature.
double in_rigid_body(const Simulation& simulation, const ProbeScene& probe) {
  const RigidHeat& heat = simulation.rigid_heat()[probe.rigid];
  if (!heat.mesh) return heat.temperature;
  double sum = 0;
  for (const NodeWeight& node : simulation.probe_nodes(probe.name))
    sum += node.weight * heat.node_temperature[node.node];
  return sum;
}

double over_set(const Simulation& simulation, const ProbeScene& probe) {
  const ParticleSet& particles = simulation.particles();
  const auto value = particle_value(simulation, probe.field, probe.component);
  double sum = 0, squares = 0, least = std::numeric_limits<double>::infinity(), most = -least;
  std::int64_t count = 0;
  for (std::size_t i = 0; i < particles.owned(); ++i) {
    if (!in_set(particles, probe.set, i)) continue;
    const double v = value(i);
    sum += v;
    least = std::min(least, v);
    most = std::max(most, v);
    ++count;
  }
  const Comm& comm = simulation.comm();
  const std::int64_t all = comm.sum(count);
  if (all == 0) return std::numeric_limits<double>::quiet_NaN();
  switch (probe.kind) {
    case ProbeScene::Kind::Average:
      return comm.sum(sum) / static_cast<double>(all);
    case ProbeScene::Kind::Deviation: {
      // About the mean: the difference of large sums would lose small deviations.
      const double mean = comm.sum(sum) / static_cast<double>(all);
      for (std::size_t i = 0; i < particles.owned(); ++i)
        if (in_set(particles, probe.set, i)) squares += std::pow(value(i) - mean, 2);
      return std::sqrt(comm.sum(squares) / static_cast<double>(all));
    }
    case ProbeScene::Kind::Minimum:
      return comm.min(least);
    case ProbeScene::Kind::Maximum:
      return comm.max(most);
    case ProbeScene::Kind::Extent: {
      const double low = comm.min(least);
      return comm.max(most) - low;
    }
    default:
      return comm.sum(sum);
  }
}

}  // namespace

double extruded_length(const Simulation& simulation, int rigid) {
  const Scene& scene = simulation.scene();
  const RigidPose& pose = simulation.rigids()[rigid].pose;
  const Vec3 face = scene.rigids[rigid].reference_point + pose.translation;
  const Vec3 outward = -1.0 * scene.rigids[rigid].motion.direction;
  const double spacing = scene.numerics.spacing;
  std::vector<double> bins(4096, 0.0);
  const ParticleSet& particles = simulation.particles();
  for (std::size_t i = 0; i < particles.owned(); ++i) {
    const double along = dot(particles.vector_at(field::position, i) - face, outward) / spacing;
    if (along >= 0 && along < static_cast<double>(bins.size())) bins[static_cast<std::size_t>(along)] += 1;
  }
  simulation.comm().sum_in_place(bins);
  const double fullest = *std::max_element(bins.begin(), bins.end());
  std::size_t filled = 0;
  while (filled < bins.size() && bins[filled] > 0 && bins[filled] >= 0.25 * fullest) ++filled;
  return static_cast<double>(filled) * spacing;
}

std::vector<double> evaluate_probes(const Simulation& simulation) {
  std::vector<double> values;
  for (const ProbeScene& probe : simulation.scene().probes) switch (probe.kind) {
      case ProbeScene::Kind::Point:
        values.push_back(probe.rigid >= 0 ? in_rigid_body(simulation, probe) : at_point(simulation, probe));
        break;
      case ProbeScene::Kind::ExtrudedLength:
        values.push_back(extruded_length(simulation, probe.rigid));
        break;
      case ProbeScene::Kind::AngularSpread:
        values.push_back(angular_spread(simulation, probe.set));
        break;
      case ProbeScene::Kind::Mixing:
        values.push_back(mixing_index(simulation, probe.set, probe.by_body));
        break;
      default:
        values.push_back(over_set(simulation, probe));
    }
  return values;
}

std::string unit_of(const Scene& scene, const std::string& name) {
  for (const DerivedQuantity& quantity : derived_quantities(scene))
    if (quantity.name == name) return std::string(quantity.unit);
  // The names are known from the declarations; a scene without that field is refused in check_field_names.
  ParticleSet all(layout_of(scene.space));
  Neighbourhood::add_fields(all);
  make_mechanics(scene.space, scene.numerics, scene.materials)->add_fields(all);
  HeatSolver::add_fields(all);
  GrainEvolution::add_fields(all);
  all.add(field::initial_position);
  const Field* field = find_field(all, name);
  return field ? std::string(field->info->unit) : "1";
}

std::string probe_unit(const Scene& scene, const ProbeScene& probe) {
  if (reads_field(probe)) return unit_of(scene, probe.field);
  if (probe.kind == ProbeScene::Kind::ExtrudedLength) return "m";
  return probe.rigid >= 0 ? "K" : "1";
}

void check_field_names(const Simulation& simulation) {
  const Scene& scene = simulation.scene();
  const ParticleSet& particles = simulation.particles();
  std::vector<std::string> known, in_snapshots;
  for (const auto& field : particles.fields()) known.emplace_back(field->info->name);
  in_snapshots = known;
  for (const DerivedQuantity& quantity : derived_quantities(scene)) {
    known.emplace_back(quantity.name);
    if (quantity.snapshot) in_snapshots.emplace_back(quantity.name);
  }
  const auto check = [&](const std::string& user, const std::string& name, const std::vector<std::string>& names) {
    if (std::find(names.begin(), names.end(), name) == names.end())
      throw InputError(scene.path + " " + user + ": this scene has no field \"" + name +
                       "\". Known: " + input::joined(names) + "." + input::did_you_mean(name, names));
  };
  for (const std::string& name : scene.output.fields) check("output.fields", name, in_snapshots);
  for (const ProbeScene& probe : scene.probes) {
    if (!reads_field(probe)) continue;
    check("probe \"" + probe.name + "\"", probe.field, known);
    const Field* field = find_field(particles, probe.field);
    if (field && probe.component >= static_cast<int>(field->components.size()))
      throw InputError(scene.path + " probe \"" + probe.name + "\": component " + std::to_string(probe.component) +
                       " of \"" + probe.field + "\" does not exist; it has " +
                       std::to_string(field->components.size()) + ".");
  }
  for (const TracerScene& tracer : scene.tracers)
    for (const std::string& name : tracer.fields) {
      check("tracer \"" + tracer.name + "\"", name, known);
      if (const Field* field = find_field(particles, name); field && field->components.size() > 1)
        throw InputError(scene.path + " tracer \"" + tracer.name + "\": \"" + name + "\" has " +
                         std::to_string(field->components.size()) +
                         " components. Allowed: fields of one component; the position is always recorded.");
    }
}

}  // namespace stirsph
