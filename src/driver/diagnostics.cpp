#include "driver/diagnostics.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "driver/probes.hpp"
#include "particles/field_names.hpp"

namespace stirsph {

double EnergyBalance::scale() const {
  return std::max({std::abs(external), initial_kinetic, kinetic, plastic + friction});
}

double EnergyBalance::unstored() const { return scale() > 0 ? (elastic - stored) / scale() : 0.0; }

double EnergyBalance::residual() const {
  const double gained = kinetic - initial_kinetic - rescaling + elastic + plastic + viscous + artificial + hourglass +
                        diffusion + unmatched + friction + contact;
  return scale() > 0 ? (gained - external) / scale() : 0.0;
}

Diagnostics diagnose(const Simulation& simulation) {
  Diagnostics d;
  const Comm& comm = simulation.comm();
  const Scene& scene = simulation.scene();
  const ParticleSet& particles = simulation.particles();
  double hottest = -std::numeric_limits<double>::infinity(), coldest = -hottest, strain = 0, inertia = 0;
  EnergyBalance local;
  if (particles.has(field::temperature)) {
    for (double t : particles[field::temperature].first(particles.owned())) {
      hottest = std::max(hottest, t);
      coldest = std::min(coldest, t);
    }
  }
  if (const Mechanics* mechanics = simulation.mechanics()) {
    const auto mass = particles[field::mass], strength = particles[field::flow_stress],
               plastic = particles[field::equivalent_plastic_strain], volume = particles[field::volume];
    for (std::size_t i = 0; i < particles.owned(); ++i) {
      const Vec3 v = particles.vector_at(field::velocity, i);
      const double v2 = dot(v, v);
      local.kinetic_physical += 0.5 * mass[i] * v2;
      strain = std::max(strain, plastic[i]);
      const Inertia& scaled = mechanics->inertia();
      const Vec3 x = particles.vector_at(field::position, i);
      local.kinetic += 0.5 * mass[i] * scaled.square(x, v);
      // A swirl without centrifugal force presses on nothing.
      const Vec3 felt = scaled.swirl ? v : v - scaled.swirl_part(x, v);
      inertia = std::max(inertia, mass[i] / volume[i] * scaled.square(x, felt) / strength[i]);
    }
    const MechanicsLedger& work = mechanics->ledger();
    local.elastic = work.elastic - work.diffusion;
    local.stored = mechanics->stored_energy(particles);
    local.plastic = work.plastic;
    local.viscous = work.viscous;
    local.artificial = work.artificial;
    local.hourglass = work.hourglass;
    local.diffusion = work.diffusion;
    local.unmatched = work.unmatched;
    local.external = simulation.load_ledger().body_force + simulation.load_ledger().grips;
  }
  std::int64_t leaked = 0, molten = 0;
  if (can_melt(scene))
    for (std::size_t i = 0; i < particles.owned(); ++i) {
      const Material& metal = scene.materials[static_cast<std::size_t>(particles[field::material][i])];
      if (metal.flow && particles[field::temperature][i] > metal.flow->melting_temperature()) ++molten;
    }
  if (Contact* contact = simulation.contact(); contact && simulation.mechanics()) {
    local.friction = contact->ledger().friction;
    local.contact = contact->ledger().normal;
    local.external += contact->ledger().external;
    for (std::size_t i = 0; i < particles.owned(); ++i)
      for (const ContactPair& pair : contact->pairs())
        if (pair.bodies[static_cast<int>(particles[field::body][i])] &&
            simulation.rigids()[pair.rigid].nearest(particles.vector_at(field::position, i)).distance <
                -0.5 * scene.numerics.spacing) {
          ++leaked;
          break;
        }
  }
  std::vector<double> sums{local.kinetic,
                           local.kinetic_physical,
                           local.elastic,
                           local.stored,
                           local.plastic,
                           local.viscous,
                           local.artificial,
                           local.hourglass,
                           local.diffusion,
                           local.unmatched,
                           local.friction,
                           local.contact,
                           local.external,
                           static_cast<double>(leaked),
                           static_cast<double>(particles.owned()),
                           static_cast<double>(molten),
                           simulation.load_ledger().rescaling};
  comm.sum_in_place(sums);
  EnergyBalance& all = d.energy;
  std::size_t next = 0;
  for (double* value :
       {&all.kinetic, &all.kinetic_physical, &all.elastic, &all.stored, &all.plastic, &all.viscous, &all.artificial,
        &all.hourglass, &all.diffusion, &all.unmatched, &all.friction, &all.contact, &all.external})
    *value = sums[next++];
  all.initial_kinetic = simulation.load_ledger().initial_kinetic;
  const double lost = sums[next++], left = sums[next++];
  d.molten = static_cast<std::int64_t>(sums[next++]);
  all.rescaling = sums[next++];
  d.leaked = static_cast<std::int64_t>(lost) + simulation.particle_count() - static_cast<std::int64_t>(left);
  std::vector<double> maxima{hottest, -coldest, strain, inertia};
  comm.max_in_place(maxima);
  d.temperature_max = maxima[0];
  d.temperature_min = -maxima[1];
  d.plastic_strain_max = maxima[2];
  d.inertia_number = maxima[3];
  d.viscous_ratio = d.energy.plastic > 0 ? d.energy.viscous / d.energy.plastic : 0.0;
  d.probes = evaluate_probes(simulation);
  return d;
}

bool can_melt(const Scene& scene) {
  return scene.mechanics && scene.heat.mode != HeatScene::Mode::Off &&
         std::any_of(scene.materials.begin(), scene.materials.end(),
                     [](const Material& m) { return m.flow && std::isfinite(m.flow->melting_temperature()); });
}

int tool_index(const Scene& scene) {
  for (std::size_t r = 0; r < scene.rigids.size(); ++r) {
    const MotionScene& motion = scene.rigids[r].motion;
    if (motion.kind != MotionScene::Kind::Fixed || motion.rotation || motion.retreat) return static_cast<int>(r);
  }
  return -1;
}

namespace {
bool exchanges_heat(const Scene& scene, const RigidScene& rigid) {
  return scene.heat.mode == HeatScene::Mode::Conduction && rigid.heat.role != RigidHeatScene::Role::Insulated;
}
}  // namespace

std::vector<HistoryColumn> history_columns(const Scene& scene) {
  std::vector<HistoryColumn> columns{{"step", "1"}, {"dt", "s"}, {"T_min", "K"}, {"T_max", "K"}};
  if (can_melt(scene)) columns.push_back({"molten", "1"});
  if (scene.mechanics) {
    for (const char* name :
         {"kinetic", "kinetic_physical", "elastic", "elastic_stored", "plastic", "viscous", "artificial_stress",
          "hourglass", "diffusion", "unmatched", "friction", "contact", "external_work"})
      columns.push_back({std::string("energy.") + name, "J"});
    for (const char* name : {"energy.residual", "kinetic_over_internal", "inertia_number", "viscous_over_plastic",
                             "plastic_strain_max", "penetration_over_dx"})
      columns.push_back({name, "1"});
    columns.push_back({"speed_max", "m/s"});
    if (scene.limits.guard_steps > 0)
      for (const char* name : guard_names) columns.push_back({std::string("guard.") + name, "1"});
    if (scene.inertia_tolerance > 0) {
      columns.push_back({"density_scale", "1"});
      columns.push_back({"energy.rescaling", "J"});
    }
  }
  for (const RigidScene& rigid : scene.rigids) {
    if (scene.mechanics) {
      for (const char* axis : {"x", "y", "z"}) columns.push_back({rigid.name + ".force_" + axis, "N"});
      columns.push_back({rigid.name + ".torque", "N m"});
      for (const char* axis : {"x", "y", "z"}) columns.push_back({rigid.name + ".displacement_" + axis, "m"});
      columns.push_back({rigid.name + ".angle", "rad"});
      columns.push_back({rigid.name + ".slip_ratio", "1"});
      columns.push_back({rigid.name + ".friction_power", "W"});
      columns.push_back({rigid.name + ".contact_area", "m2"});
      columns.push_back({rigid.name + ".contact_pressure", "Pa"});
      if (rigid.motion.kind == MotionScene::Kind::Force) {
        columns.push_back({rigid.name + ".target_force", "N"});
        columns.push_back({rigid.name + ".at_velocity_limit", "1"});
        columns.push_back({rigid.name + ".phase", "1"});
      }
    }
    if (exchanges_heat(scene, rigid)) {
      columns.push_back({rigid.name + ".temperature", "K"});
      for (const char* name : {".heat", ".interface_heat", ".surface_heat", ".friction_heat"})
        columns.push_back({rigid.name + name, "J"});
    }
  }
  for (const GripScene& grip : scene.grips) {
    for (const char* axis : {"x", "y", "z"}) columns.push_back({grip.name + ".force_" + axis, "N"});
    for (const char* axis : {"x", "y", "z"}) columns.push_back({grip.name + ".torque_" + axis, "N m"});
  }
  if (scene.heat.mode == HeatScene::Mode::Conduction) {
    for (const char* name : {"particles", "rigid", "source", "fixed", "ambient"})
      columns.push_back({std::string("heat.") + name, "J"});
    columns.push_back({"heat.residual", "1"});
  }
  for (const ProbeScene& probe : scene.probes) columns.push_back({probe.name, probe_unit(scene, probe)});
  return columns;
}

std::vector<double> history_row(const Simulation& simulation, const Diagnostics& d) {
  const Scene& scene = simulation.scene();
  const Comm& comm = simulation.comm();
  std::vector<double> row{static_cast<double>(simulation.clock().step), simulation.clock().dt, d.temperature_min,
                          d.temperature_max};
  const auto put = [&](std::initializer_list<double> values) { row.insert(row.end(), values); };
  if (can_melt(scene)) put({static_cast<double>(d.molten)});
  if (scene.mechanics) {
    const EnergyBalance& e = d.energy;
    const double internal = e.elastic + e.plastic;
    put({e.kinetic,
         e.kinetic_physical,
         e.elastic,
         e.stored,
         e.plastic,
         e.viscous,
         e.artificial,
         e.hourglass,
         e.diffusion,
         e.unmatched,
         e.friction,
         e.contact,
         e.external,
         e.residual(),
         internal > 0 ? e.kinetic / internal : 0.0,
         d.inertia_number,
         d.viscous_ratio,
         d.plastic_strain_max,
         simulation.largest_penetration() / scene.numerics.spacing,
         simulation.largest_speed()});
    if (const InertiaGuards* guards = simulation.guards())
      for (int k = 0; k < guard_count; ++k) put({guards->value(static_cast<Guard>(k))});
    if (const ScalingSchedule* schedule = simulation.schedule()) put({schedule->scale(), e.rescaling});
  }
  std::vector<double> contact(5 * scene.rigids.size(), 0.0);
  if (scene.mechanics && simulation.contact() && !simulation.contact()->loads().empty()) {
    for (std::size_t r = 0; r < scene.rigids.size(); ++r) {
      const ContactLoad& load = simulation.contact()->loads()[r];
      const double values[] = {load.sliding_speed, load.surface_speed, load.friction_power, load.area,
                               load.normal_force};
      std::copy(std::begin(values), std::end(values), contact.begin() + 5 * r);
    }
  }
  comm.sum_in_place(contact);
  for (std::size_t r = 0; r < scene.rigids.size(); ++r) {
    const RigidPose& pose = simulation.rigids()[r].pose;
    const RigidMotion& motion = simulation.motions()[r];
    if (scene.mechanics) {
      const Vec3 force = simulation.rigid_force(static_cast<int>(r));
      const double* c = &contact[5 * r];
      put({force.x, force.y, force.z, dot(simulation.rigid_torque(static_cast<int>(r)), pose.axis), pose.translation.x,
           pose.translation.y, pose.translation.z, pose.angle, c[1] > 0 ? c[0] / c[1] : 0.0, c[2], c[3],
           c[3] > 0 ? c[4] / c[3] : 0.0});
      if (const ForceControl* control = motion.force_control()) {
        constexpr double retreat = 5;  // after those of ForceControl::Phase
        put({motion.retreating() ? 0.0 : control->target_force(), control->at_velocity_limit() ? 1.0 : 0.0,
             motion.retreating() ? retreat : static_cast<double>(control->phase())});
      }
    }
    if (exchanges_heat(scene, scene.rigids[r])) {
      const BodyHeat& heat = simulation.heat_ledger().bodies[r];
      put({simulation.rigid_heat()[r].temperature, heat.gained, heat.interface, heat.surface, heat.friction});
    }
  }
  if (!scene.grips.empty()) {
    std::vector<double> loads(6 * scene.grips.size(), 0.0);
    for (std::size_t g = 0; g < simulation.grip_loads().size(); ++g)
      for (int k = 0; k < 3; ++k) {
        loads[6 * g + k] = simulation.grip_loads()[g].force[k];
        loads[6 * g + 3 + k] = simulation.grip_loads()[g].torque[k];
      }
    comm.sum_in_place(loads);
    row.insert(row.end(), loads.begin(), loads.end());
  }
  if (scene.heat.mode == HeatScene::Mode::Conduction) {
    const HeatLedger& heat = simulation.heat_ledger();
    put({heat.particles, heat.rigid, heat.source, heat.fixed, heat.ambient, heat.residual()});
  }
  row.insert(row.end(), d.probes.begin(), d.probes.end());
  return row;
}

}  // namespace stirsph
