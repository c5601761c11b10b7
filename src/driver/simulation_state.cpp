/// Everything besides particle fields that a continued run needs.
#include <algorithm>
#include <utility>

#include "driver/simulation.hpp"
#include "particles/field_names.hpp"

namespace stirsph {
namespace {

/// This rank's partial sums in a fixed order: pointers to read from (all const) or to restore through.
template <class Mechanical, class Touching, class Loads>
auto partial_sums(Mechanical* mechanics, Touching* contact, Loads& loads) {
  std::vector<decltype(&loads.grips)> sums{&loads.body_force, &loads.grips, &loads.rescaling};
  if (mechanics)
    for (auto* value : {&mechanics->elastic, &mechanics->plastic, &mechanics->viscous, &mechanics->artificial,
                        &mechanics->hourglass, &mechanics->diffusion, &mechanics->unmatched, &mechanics->plastic_heat})
      sums.push_back(value);
  if (contact)
    for (auto* value : {&contact->external, &contact->friction, &contact->normal, &contact->friction_heat})
      sums.push_back(value);
  return sums;
}

}  // namespace

NamedState Simulation::named_state() const {
  NamedState state;
  std::vector<double> partial;
  const MechanicsLedger* mechanical = mechanics_ ? &std::as_const(*mechanics_).ledger() : nullptr;
  const ContactLedger* touching = contact_ ? &std::as_const(*contact_).ledger() : nullptr;
  for (const double* value : partial_sums(mechanical, touching, load_ledger_)) partial.push_back(*value);
  state.numbers["ranks"] = {static_cast<double>(comm_.size())};
  state.numbers["partial_sums"] = comm_.all_gather(partial);
  state.numbers["clock"] = {clock_.time, static_cast<double>(clock_.step), clock_.dt, clock_.next_dt};
  state.numbers["step_state"] = {speed_,
                                 penetration_,
                                 least_h_,
                                 time_since_heat_,
                                 list_expired_ ? 1.0 : 0.0,
                                 static_cast<double>(particle_count_)};
  state.numbers["pair_list"] = neighbourhood_->state();
  state.numbers["repartition"] = {repartition_rule_.state()};
  state.numbers["initial_kinetic"] = {load_ledger_.initial_kinetic};
  state.numbers["heat_ledger"] = {heat_ledger_.particles, heat_ledger_.rigid, heat_ledger_.source, heat_ledger_.fixed,
                                  heat_ledger_.ambient};
  state.numbers["contact_step"] = {contact_ ? contact_->contact_step() : 0.0};
  if (guards_) state.numbers["inertia_guards"] = guards_->state();
  if (schedule_) state.numbers["scaling_schedule"] = schedule_->state();
  for (std::size_t r = 0; r < rigids_.size(); ++r) {
    const RigidPose& pose = rigids_[r].pose;
    std::vector<double> values{pose.angle, pose.angular_velocity, rigid_heat_[r].temperature};
    for (const Vec3& v : {pose.translation, pose.velocity, rigid_force_[r], rigid_torque_[r]})
      for (int d = 0; d < 3; ++d) values.push_back(v[d]);
    state.numbers["rigid_" + rigids_[r].name] = values;
    state.numbers["controller_" + rigids_[r].name] = motions_[r].state();
    const BodyHeat& heat = heat_ledger_.bodies[r];
    state.numbers["heat_" + rigids_[r].name] = {heat.gained, heat.interface, heat.surface, heat.friction};
    if (rigid_heat_[r].mesh) state.numbers["mesh_temperature_" + rigids_[r].name] = rigid_heat_[r].node_temperature;
  }
  std::vector<double> counts;
  for (const BodyCount& body : body_counts_) {
    counts.push_back(static_cast<double>(body.particles));
    counts.push_back(body.mass);
  }
  state.numbers["body_counts"] = counts;
  state.texts["effective_input"] = scene_.effective_input;
  return state;
}

void Simulation::resume(const std::string& checkpoint) {
  const NamedState state = read_checkpoint(comm_, checkpoint, particles_);
  const auto numbers = [&](const std::string& name, std::size_t least) -> const std::vector<double>& {
    const auto found = state.numbers.find(name);
    if (found == state.numbers.end() || found->second.size() < least)
      throw InputError(checkpoint + " does not fit the scene " + scene_.path + ": it has no state \"" + name +
                       "\". Restart with the scene the checkpoint was made with.");
    return found->second;
  };
  const auto& clock = numbers("clock", 4);
  clock_ = {clock[0], static_cast<std::int64_t>(clock[1]), clock[2], clock[3]};
  const auto& step = numbers("step_state", 6);
  speed_ = step[0];
  penetration_ = step[1];
  least_h_ = step[2];
  time_since_heat_ = step[3];
  list_expired_ = step[4] != 0;
  particle_count_ = static_cast<std::int64_t>(step[5]);
  load_ledger_.initial_kinetic = numbers("initial_kinetic", 1)[0];
  const auto& heat = numbers("heat_ledger", 5);
  heat_ledger_ = {heat[0], heat[1], heat[2], heat[3], heat[4], std::vector<BodyHeat>(rigids_.size())};
  if (guards_) guards_->restore(numbers("inertia_guards", InertiaGuards::state_size));
  if (schedule_) {
    schedule_->restore(numbers("scaling_schedule", ScalingSchedule::state_size));
    set_density_scale(schedule_->scale());
  }
  if (contact_) contact_->contact_step() = numbers("contact_step", 1)[0];
  for (std::size_t r = 0; r < rigids_.size(); ++r) {
    const auto& values = numbers("rigid_" + rigids_[r].name, 15);
    RigidPose& pose = rigids_[r].pose;
    pose.angle = values[0];
    pose.angular_velocity = values[1];
    rigid_heat_[r].temperature = values[2];
    std::size_t at = 3;
    for (Vec3* v : {&pose.translation, &pose.velocity, &rigid_force_[r], &rigid_torque_[r]})
      for (int d = 0; d < 3; ++d) (*v)[d] = values[at++];
    motions_[r].restore(numbers("controller_" + rigids_[r].name, motions_[r].state().size()));
    const auto& body = numbers("heat_" + rigids_[r].name, 4);
    heat_ledger_.bodies[r] = {body[0], body[1], body[2], body[3]};
    if (!rigid_heat_[r].mesh) continue;
    const auto& nodes = numbers("mesh_temperature_" + rigids_[r].name, 1);
    if (nodes.size() != rigid_heat_[r].mesh->nodes())
      throw InputError(checkpoint + " does not fit the scene " + scene_.path + ": the mesh of \"" + rigids_[r].name +
                       "\" had " + std::to_string(nodes.size()) + " nodes and now has " +
                       std::to_string(rigid_heat_[r].mesh->nodes()) + ". Restart with the same mesh.");
    rigid_heat_[r].node_temperature = nodes;
  }
  const auto& counts = numbers("body_counts", 2 * scene_.bodies.size());
  for (std::size_t b = 0; b < scene_.bodies.size(); ++b)
    body_counts_.push_back({scene_.bodies[b].name, static_cast<std::int64_t>(counts[2 * b]), counts[2 * b + 1]});

  const bool same_ranks = static_cast<int>(numbers("ranks", 1)[0]) == comm_.size();
  const auto targets = partial_sums(mechanics_ ? &mechanics_->ledger() : nullptr,
                                    contact_ ? &contact_->ledger() : nullptr, load_ledger_);
  const auto& partial = numbers("partial_sums", targets.size());
  for (std::size_t k = 0; k < targets.size(); ++k) {
    // The same rank takes its own share back; on another rank count the root takes everything.
    *targets[k] = 0;
    const std::size_t writers = partial.size() / targets.size();
    for (std::size_t owner = 0; owner < writers; ++owner)
      if (same_ranks ? static_cast<int>(owner) == comm_.rank() : comm_.is_root())
        *targets[k] += partial[owner * targets.size() + k];
  }

  const auto& list = numbers("pair_list", 4);
  if (same_ranks) {
    repartition_rule_.restore(numbers("repartition", 1)[0]);
    neighbourhood_->restore(particles_, list);
  } else {
    neighbourhood_->rebuild(particles_, list[0] - neighbourhood_->skin(), true);
  }
  if (contact_) contact_->forget_candidates();
  collect_grip_members();
  measure_extent();
}

}  // namespace stirsph
