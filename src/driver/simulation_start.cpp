/// From a scene to the first step.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "driver/simulation.hpp"
#include "particles/field_names.hpp"

namespace stirsph {

Simulation::Simulation(Comm comm, Scene scene)
    : comm_(comm),
      scene_(std::move(scene)),
      particles_(layout_of(scene_.space)),
      repartition_rule_(scene_.repartition_imbalance) {
  const double spacing = scene_.numerics.spacing;
  neighbourhood_ = std::make_unique<Neighbourhood>(comm_, scene_.domain, scene_.skin * spacing);
  if (scene_.mechanics) {
    MechanicsSettings settings = scene_.numerics;
    settings.heat_input = scene_.heat.mode != HeatScene::Mode::Off;
    settings.rigid_grips = std::any_of(scene_.grips.begin(), scene_.grips.end(),
                                       [&](const GripScene& grip) { return grip.rigid(scene_.space); });
    mechanics_ = make_mechanics(scene_.space, settings, scene_.materials);
    if (scene_.limits.guard_steps > 0) guards_ = std::make_unique<InertiaGuards>(scene_);
    if (scene_.inertia_tolerance > 0) schedule_ = std::make_unique<ScalingSchedule>(scene_);
  }
  if (scene_.heat.mode == HeatScene::Mode::Conduction) {
    HeatSettings settings;
    settings.spacing = spacing;
    settings.smoothing_length = scene_.numerics.h_over_dx * spacing;
    settings.relative_tolerance = scene_.heat.relative_tolerance;
    settings.nonlinear_iterations = scene_.heat.nonlinear_iterations;
    if (scene_.heat.crank_nicolson) settings.scheme = HeatSettings::Scheme::CrankNicolson;
    std::vector<ThermalProperties> thermal;
    for (const Material& material : scene_.materials) thermal.push_back(material.thermal);
    heat_ = std::make_unique<HeatSolver>(comm_, scene_.numerics.kernel, layout_of(scene_.space).dim, settings, thermal);
  }
  if (scene_.microstructure) grains_ = std::make_unique<GrainEvolution>(*scene_.microstructure, grain_laws(scene_));
  vote_ = std::make_unique<StepVote>(comm_, 6 * scene_.rigids.size());
  prepare_rigids();
  build_contact();
  add_fields();
}

Simulation::~Simulation() = default;

void Simulation::add_fields() {
  Neighbourhood::add_fields(particles_);
  if (mechanics_) mechanics_->add_fields(particles_);
  if (contact_) contact_->add_fields(particles_);
  if (contact_ && scene_.output.contact_traction) particles_.add(field::contact_traction);
  if (heat_) HeatSolver::add_fields(particles_);
  if (scene_.heat.mode != HeatScene::Mode::Off) particles_.add(field::heat_input);
  if (contact_ && interfaces_ && !interfaces_->interfaces().empty()) {
    const int count = static_cast<int>(interfaces_->interfaces().size());
    particles_.add(field::rigid_heat, count);
    for (const RigidScene& rigid : scene_.rigids)
      if (rigid.heat.pressure_conductance > 0) particles_.add(field::rigid_impulse, count);
  }
  if (!scene_.sets.empty()) particles_.add(field::sets);
  if (!scene_.grips.empty() || scene_.output.initial_position) particles_.add(field::initial_position);
  if (grains_) GrainEvolution::add_fields(particles_);
}

BilletStiffness Simulation::billet_stiffness(const RigidScene& rigid) const {
  BilletStiffness billet;
  for (const ContactScene& contact : scene_.contacts) {
    if (&scene_.rigids[contact.rigid] != &rigid) continue;
    double low = std::numeric_limits<double>::infinity(), high = -low, volume = 0, modulus = 0, density = 0;
    const std::vector<BodyCount> counts = count_particles(scene_);
    for (std::size_t b = 0; b < scene_.bodies.size(); ++b) {
      if (!contact.bodies[b]) continue;
      const Material& material = scene_.materials[scene_.bodies[b].material];
      const Bounds bounds = scene_.bodies[b].shape->bounds();
      for (int corner = 0; corner < 8; ++corner) {
        const Vec3 point{corner & 1 ? bounds.high.x : bounds.low.x, corner & 2 ? bounds.high.y : bounds.low.y,
                         corner & 4 ? bounds.high.z : bounds.low.z};
        const double along = dot(point, rigid.motion.direction);
        low = std::min(low, along);
        high = std::max(high, along);
      }
      const double part = counts[b].mass / material.density;
      volume += part;
      modulus += part * material.youngs_modulus;
      density += counts[b].mass;
    }
    const double length = high - low;
    modulus *= scene_.numerics.elastic_scale / volume;
    density *= (mechanics_ ? mechanics_->inertia().scale : scene_.numerics.density_scale) / volume;
    billet.stiffness = modulus * volume / (length * length);
    billet.impedance = std::sqrt(density * modulus) * volume / length;
    billet.angular_frequency = 0.5 * std::numbers::pi * std::sqrt(modulus / density) / length;
  }
  return billet;
}

void Simulation::prepare_rigids() {
  for (const RigidScene& rigid : scene_.rigids) {
    BilletStiffness billet;
    if (rigid.motion.kind == MotionScene::Kind::Force) {
      billet = billet_stiffness(rigid);
      if (billet.stiffness <= 0)
        throw InputError(scene_.path + " rigid \"" + rigid.name +
                         "\": force control needs a [[contact]] of this body with the billet it presses.");
    }
    motions_.emplace_back(rigid.motion, billet);
    rigids_.push_back({rigid.name, rigid.shape, motions_.back().initial_pose()});
  }
  rigid_heat_ = make_rigid_heat(comm_, scene_);
  if (scene_.heat.mode == HeatScene::Mode::Conduction)
    interfaces_ = std::make_unique<InterfaceSearch>(
        heat_interfaces(scene_), rigids_, rigid_heat_, scene_.domain, layout_of(scene_.space), scene_.numerics.kernel,
        scene_.numerics.spacing, scene_.numerics.h_over_dx * scene_.numerics.spacing);
  heat_ledger_.bodies.resize(rigids_.size());
  place_probes();
  rigid_force_.resize(rigids_.size());
  rigid_torque_.resize(rigids_.size());
}

void Simulation::place_probes() {
  for (const ProbeScene& probe : scene_.probes) {
    if (probe.kind != ProbeScene::Kind::Point || probe.rigid < 0 || !rigid_heat_[probe.rigid].mesh) continue;
    try {
      probe_nodes_[probe.name] = nodes_around(*rigid_heat_[probe.rigid].mesh, probe.position);
    } catch (const InputError& error) {
      throw InputError(scene_.path + " probe \"" + probe.name + "\": " + error.what());
    }
  }
}

void Simulation::build_contact() {
  if (scene_.contacts.empty()) return;
  std::vector<ContactPair> pairs;
  for (const ContactScene& contact : scene_.contacts) {
    ContactPair pair;
    pair.rigid = contact.rigid;
    pair.bodies = contact.bodies;
    pair.friction = contact.friction;
    pair.shear_limit_factor = contact.shear_limit_factor;
    pair.shear_limit = contact.shear_limit;
    pair.penalty_scale = contact.penalty_scale;
    pair.soft_scale = contact.soft_scale;
    pair.damping = contact.damping;
    pair.heat_conversion = contact.heat_conversion;
    if (interfaces_)
      for (const HeatInterface& interface : interfaces_->interfaces())
        if (interface.rigid == contact.rigid) pair.heat_component = interface.component;
    const int rigid_material = scene_.rigids[contact.rigid].material;
    for (const Material& material : scene_.materials) {
      double share = contact.heat_share;
      if (share < 0)
        share = rigid_material >= 0 && material.has_thermal && scene_.materials[rigid_material].has_thermal
                    ? heat_partition(material, scene_.materials[rigid_material], 293.15)
                    : 1.0;
      pair.heat_share.push_back(share);
    }
    pairs.push_back(std::move(pair));
  }
  std::vector<ContactMaterial> materials;
  for (const Material& material : scene_.materials)
    materials.push_back({material.youngs_modulus * scene_.numerics.elastic_scale, material.flow});
  contact_ = std::make_unique<Contact>(
      std::move(pairs), layout_of(scene_.space), scene_.numerics.spacing, std::move(materials),
      inertia_of(scene_.numerics, layout_of(scene_.space).axisymmetric()), scene_.numerics.surface_layers);
}

void Simulation::refuse_overlaps() {
  if (!contact_) return;
  // A tenth of a spacing is what a lattice that does not divide the body may need; more is a mistake in the scene.
  const double allowed = 0.1 * scene_.numerics.spacing;
  const auto overlaps = contact_->overlaps(particles_, rigids_);
  comm_.together([&] {
    for (std::size_t p = 0; p < overlaps.size(); ++p) {
      if (overlaps[p].depth <= allowed) continue;
      const Vec3& x = overlaps[p].position;
      throw InputError(scene_.path + " rigid \"" + scene_.rigids[contact_->pairs()[p].rigid].name +
                       "\": it overlaps a deformable body at the start: particle " + std::to_string(overlaps[p].id) +
                       " at (" + std::to_string(1e3 * x.x) + ", " + std::to_string(1e3 * x.y) + ", " +
                       std::to_string(1e3 * x.z) + ") mm is " + std::to_string(1e3 * overlaps[p].depth) +
                       " mm deep, allowed are " + std::to_string(1e3 * allowed) +
                       " mm. A particle's surface lies half a spacing outside its centre: set fill_margin = 0.5 of the "
                       "body where it "
                       "fits closely, or move or shrink one of them.");
    }
  });
}

void Simulation::refuse_misplaced_meshes() {
  if (!interfaces_) return;
  comm_.together([&] {
    try {
      interfaces_->check_fit(particles_, rigids_, rigid_heat_);
    } catch (const InputError& error) {
      throw InputError(scene_.path + " " + error.what());
    }
  });
}

void Simulation::refuse_coincident_particles() {
  // Sites of a lattice are a spacing apart, those of two bodies that touch at least half of one.
  const auto least_between = [&](std::size_t i, std::size_t j) {
    const auto one = static_cast<std::size_t>(particles_[field::body][i]),
               other = static_cast<std::size_t>(particles_[field::body][j]);
    const bool turned = particles_.layout().axisymmetric() && particles_.component(field::position, 0)[j] < 0;
    const bool jitter = scene_.bodies[one].jitter > 0 || scene_.bodies[other].jitter > 0;
    return scene_.numerics.spacing * (turned || jitter ? 0.1 : one == other ? 0.6 : 0.45);
  };
  const PairList& pairs = neighbourhood_->pairs();
  comm_.together([&] {
    for (std::size_t c = 0; c < pairs.clusters(); ++c)
      for (std::size_t i = c * cluster_size; i < std::min((c + 1) * cluster_size, particles_.owned()); ++i) {
        const Vec3 x = particles_.vector_at(field::position, i);
        for (const std::int32_t j : pairs.candidates(c)) {
          if (static_cast<std::size_t>(j) == i) continue;
          const double apart = norm(x - particles_.vector_at(field::position, j));
          if (apart >= least_between(i, static_cast<std::size_t>(j))) continue;
          const auto named = [&](std::size_t k) {
            const auto id = static_cast<std::int64_t>(particles_[field::id][k]);
            std::size_t b = 0;
            for (std::int64_t end = body_counts_[0].particles; id >= end; end += body_counts_[b].particles) ++b;
            return std::to_string(id) + " of " + body_counts_[b].name;
          };
          throw InputError(
              scene_.path + ": particles " + named(i) + " and " + named(j) +
              fmt::format(" sit on each other, {:.2g} spacings apart, at (", apart / scene_.numerics.spacing) +
              std::to_string(1e3 * x.x) + ", " + std::to_string(1e3 * x.y) + ", " + std::to_string(1e3 * x.z) +
              ") mm: bodies overlap, or the periodic box is smaller than a body or no multiple of the spacing. Cut one "
              "shape with a "
              "difference, or move it.");
        }
      }
  });
}

/// A fixed step that no kernel could bear (time.cfl goes up to 3, the largest stable Courant number is 2.3).
void Simulation::refuse_hopeless_step() {
  const double most = 3 * least_h_ / (mechanics_->wave_speed() + speed_);
  if (scene_.time.fixed_step <= most) return;
  throw InputError(fmt::format(
      "{}: time.step = {:.4g} s has a Courant number of {:.3g}, and no run is stable above 2.3. Allowed: up to {:.3g} "
      "s "
      "here, better {:.3g} s; leave time.step out to have the step follow the Courant number",
      scene_.path, scene_.time.fixed_step, 3 * scene_.time.fixed_step / most, most, scene_.time.cfl * most / 3));
}

void Simulation::refuse_empty_sets() {
  std::vector<double> members(scene_.sets.size());
  for (std::size_t s = 0; s < members.size(); ++s)
    for (const double mask : particles_[field::sets].first(particles_.owned()))
      members[s] += static_cast<double>(static_cast<std::uint64_t>(mask) >> s & 1);
  comm_.sum_in_place(members);
  for (std::size_t s = 0; s < members.size(); ++s)
    if (members[s] == 0)
      throw InputError(scene_.path + " set \"" + scene_.sets[s].name +
                       "\": it holds no particle. Particle centres lie at least half a spacing inside their body: "
                       "enlarge or move the region, or correct the bodies");
}

void Simulation::mark_held_particles() {
  if (!particles_.has(field::held)) return;
  const auto held = particles_[field::held], mask = particles_[field::sets];
  for (const GripScene& grip : scene_.grips)
    if (grip.rigid(scene_.space))
      for (std::size_t i = 0; i < particles_.owned(); ++i)
        if (static_cast<std::uint64_t>(mask[i]) >> grip.set & 1) held[i] = 1;
}

void Simulation::collect_grip_members() {
  grip_members_.assign(scene_.grips.size(), {});
  for (std::size_t g = 0; g < scene_.grips.size(); ++g) {
    const auto bit = std::uint64_t(1) << scene_.grips[g].set;
    const auto mask = particles_[field::sets];
    for (std::size_t i = 0; i < particles_.owned(); ++i)
      if (static_cast<std::uint64_t>(mask[i]) & bit) grip_members_[g].push_back(static_cast<std::int32_t>(i));
  }
}

void Simulation::set_grip_velocities() {
  for (std::size_t g = 0; g < scene_.grips.size(); ++g)
    for (const std::int32_t i : grip_members_[g]) {
      const GripScene& grip = scene_.grips[g];
      const Vec3 x = particles_.vector_at(field::position, i);
      Vec3 v = particles_.vector_at(field::velocity, i);
      if (grip.rotation) {
        const Vec3& axis = grip.rotation->axis;
        v = dot(v, axis) * axis + grip.rotation->rate({0.0}) * cross(axis, x - grip.rotation->centre);
      }
      for (int d = 0; d < particles_.layout().velocity_components; ++d) {
        if (grip.velocity[d]) v[d] = (*grip.velocity[d])({0.0, x.x, x.y, x.z});
        particles_.component(field::velocity, d)[i] = v[d];
      }
    }
}

void Simulation::start() {
  comm_.together([&] { body_counts_ = populate(scene_, comm_, particles_); });
  for (BodyCount& body : body_counts_) body.mass = comm_.sum(body.mass);
  particle_count_ = comm_.sum(static_cast<std::int64_t>(particles_.owned()));
  refuse_empty_sets();
  mark_held_particles();
  if (mechanics_) mechanics_->initialise(particles_);
  if (contact_) contact_->initialise(particles_);
  if (grains_) grains_->initialise(particles_);
  refuse_overlaps();

  const double support = comm_.max(mechanics_ ? mechanics_->support(particles_)
                                              : scene_.numerics.h_over_dx * scene_.numerics.spacing *
                                                    kernel_support(scene_.numerics.kernel));
  neighbourhood_->rebuild(particles_, support, true);
  refuse_coincident_particles();
  refuse_misplaced_meshes();
  clock_.next_dt = scene_.time.fixed_step;
  if (!mechanics_) return;

  collect_grip_members();
  comm_.together([&] { set_grip_velocities(); });
  neighbourhood_->halo().exchange(particles_, Halo::Kinematic);

  measure_extent();
  for (std::size_t i = 0; i < particles_.owned(); ++i)
    speed_ = std::max(speed_, norm(particles_.vector_at(field::velocity, i)));
  speed_ = comm_.max(speed_);
  load_ledger_.initial_kinetic = comm_.sum(kinetic_energy());
  least_h_ = comm_.min(mechanics_->least_smoothing_length(particles_));
  comm_.together([&] { refuse_hopeless_step(); });
  clock_.next_dt = stable_step();

  // The first kick needs the initial acceleration; work and heat are counted from the first step on.
  mechanics_->update_acceleration(particles_, neighbourhood_->pairs(), 0.0);
  apply_loads(clock_.next_dt);
  mechanics_->ledger() = {};
  if (contact_) contact_->ledger() = {};
  if (particles_.has(field::heat_input)) std::ranges::fill(particles_[field::heat_input], 0.0);
  for (const FieldInfo* info : {&field::rigid_heat, &field::rigid_impulse})
    if (particles_.has(*info))
      for (const HeatInterface& interface : interfaces_->interfaces())
        std::ranges::fill(particles_.component(*info, interface.component), 0.0);
  load_ledger_.body_force = load_ledger_.grips = 0;
  vote();
}

}  // namespace stirsph
