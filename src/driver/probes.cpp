#include "driver/probes.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "driver/mixing.hpp"
#include "driver/particle_values.hpp"
#include "input/wording.hpp"
#include "particles/field_names.hpp"
#include "thermal/ring.hpp"

namespace stirsph {
namespace {

/// Whether a probe reads a particle field at all.
bool reads_field(const ProbeScene& probe) {
  using Kind = ProbeScene::Kind;
  return probe.kind != Kind::ExtrudedLength && probe.kind != Kind::AngularSpread && probe.kind != Kind::Mixing &&
         probe.rigid < 0;
}

/// What the probed quantity of a ring becomes on the far side of the axis, where r and theta point the other way: 1 or
/// -1.
double mirrored_sign(const ParticleSet& particles, const ProbeScene& probe) {
  const Field* field = find_field(particles, probe.field);
  if (!field) return 1;  // pressure and von Mises stress
  switch (field->info->shape) {
    case Shape::Position:
      return probe.component == 0 ? -1 : 1;
    case Shape::Velocity:
      return probe.component < 2 ? -1 : 1;
    case Shape::SymmetricTensor:
      return probe.component < 4 ? 1 : -1;  // rz, tz
    default:
      return 1;
  }
}

/// Kernel interpolation with normalised weights (Shepard), so that a probe near a surface is not biased towards zero.
/// In the axisymmetric space it takes place in the half-plane, into which the probe's position is turned, with sections
/// of rings for volumes and their images beyond the axis for neighbours.
double at_point(const Simulation& simulation, const ProbeScene& probe) {
  const ParticleSet& particles = simulation.particles();
  const auto value = particle_value(simulation, probe.field, probe.component);
  const auto h = particles[field::smoothing_length], volume = particles[field::volume];
  const SpaceLayout layout = particles.layout();
  const bool rings = layout.axisymmetric();
  const Vec3 place = rings ? turned_into_half_plane(probe.position) : probe.position;
  const double image = rings ? mirrored_sign(particles, probe) : 0;
  double weight_sum = 0, sum = 0;
  for (std::size_t i = 0; i < particles.owned(); ++i) {
    Vec3 x = particles.vector_at(field::position, i);
    const double measure = rings ? volume[i] / circumference(x.x) : volume[i];
    const auto weight = [&] {
      const double r = norm(x - place);
      return std::visit(
          [&]<class K>(const K&) {
            return r < K::support * h[i] ? measure * kernel_value<K>(r, h[i], layout.dim) : 0.0;
          },
          simulation.scene().numerics.kernel);
    };
    const double direct = weight();
    weight_sum += direct;
    sum += direct * value(i);
    if (!rings) continue;
    x.x = -x.x;
    const double mirrored = weight();
    weight_sum += mirrored;
    sum += mirrored * image * value(i);
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

/// Whether the probe asks for the radius of rings.
bool is_radius(const ParticleSet& particles, const ProbeScene& probe) {
  const Field* field = find_field(particles, probe.field);
  return field && field->info->shape == Shape::Position && field->info->unit == field::position.unit &&
         probe.component == 0;
}

double over_set(const Simulation& simulation, const ProbeScene& probe) {
  const ParticleSet& particles = simulation.particles();
  const auto value = particle_value(simulation, probe.field, probe.component);
  // A ring stands for as many particles of three dimensions as its volume holds.
  const bool rings = particles.layout().axisymmetric();
  const bool mean = probe.kind == ProbeScene::Kind::Average || probe.kind == ProbeScene::Kind::Deviation;
  const auto volume = particles[field::volume];
  const auto weight_of = [&](std::size_t i) { return rings && mean ? volume[i] : 1.0; };
  double sum = 0, squares = 0, weights = 0, least = std::numeric_limits<double>::infinity(), most = -least;
  std::int64_t count = 0;
  for (std::size_t i = 0; i < particles.owned(); ++i) {
    if (!in_set(particles, probe.set, i)) continue;
    const double v = value(i);
    const double weight = weight_of(i);
    sum += weight * v;
    weights += weight;
    least = std::min(least, v);
    most = std::max(most, v);
    ++count;
  }
  const Comm& comm = simulation.comm();
  const std::int64_t all = comm.sum(count);
  if (all == 0) return std::numeric_limits<double>::quiet_NaN();
  switch (probe.kind) {
    case ProbeScene::Kind::Average:
      return comm.sum(sum) / comm.sum(weights);
    case ProbeScene::Kind::Deviation: {
      // About the mean: the difference of large sums would lose small deviations.
      const double weight = comm.sum(weights), average = comm.sum(sum) / weight;
      for (std::size_t i = 0; i < particles.owned(); ++i)
        if (in_set(particles, probe.set, i)) squares += weight_of(i) * std::pow(value(i) - average, 2);
      return std::sqrt(comm.sum(squares) / weight);
    }
    case ProbeScene::Kind::Minimum:
      return comm.min(least);
    case ProbeScene::Kind::Maximum:
      return comm.max(most);
    case ProbeScene::Kind::Extent: {
      const double low = comm.min(least), high = comm.max(most);
      // Across the axis it is a diameter.
      return rings && is_radius(particles, probe) ? 2 * high : high - low;
    }
    default:
      return comm.sum(sum);
  }
}

}  // namespace

std::size_t unbroken_bins(const std::vector<double>& bins) {
  const auto around = [&](std::size_t k) {
    double sum = 0;
    for (std::size_t n = k > 0 ? k - 1 : 0; n < std::min(k + 2, bins.size()); ++n) sum += bins[n];
    return sum;
  };
  double fullest = 0;
  for (std::size_t k = 0; k < bins.size(); ++k) fullest = std::max(fullest, around(k));
  std::size_t filled = 0;
  while (filled < bins.size() && fullest > 0 && around(filled) >= 0.25 * fullest) ++filled;
  return filled;
}

double extruded_length(const Simulation& simulation, int rigid) {
  const Scene& scene = simulation.scene();
  const RigidPose& pose = simulation.rigids()[rigid].pose;
  const Vec3 face = scene.rigids[rigid].reference_point + pose.translation;
  const Vec3 outward = -1.0 * scene.rigids[rigid].motion.direction;
  const double spacing = scene.numerics.spacing;
  std::vector<double> bins(4096, 0.0);
  const ParticleSet& particles = simulation.particles();
  const bool rings = particles.layout().axisymmetric();
  const auto volume = particles[field::volume];
  // Spacings beyond the face.
  const auto height = [&](std::size_t i) {
    return dot(particles.vector_at(field::position, i) - face, outward) / spacing;
  };
  const auto within = [](double along, std::size_t count) { return along >= 0 && along < static_cast<double>(count); };
  for (std::size_t i = 0; i < particles.owned(); ++i)
    if (const double along = height(i); within(along, bins.size()))
      bins[static_cast<std::size_t>(along)] += rings ? volume[i] : 1.0;
  simulation.comm().sum_in_place(bins);
  const std::size_t filled = unbroken_bins(bins);
  double farthest = 0;
  for (std::size_t i = 0; i < particles.owned(); ++i)
    if (const double along = height(i); within(along, filled)) farthest = std::max(farthest, along + 0.5);
  return simulation.comm().max(farthest) * spacing;
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
  for (const FieldInfo* info : {&field::initial_position, &field::contact_traction, &field::layer_stretch})
    all.add(*info);
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
