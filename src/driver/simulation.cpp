/// The time step. Start and restart live in simulation_start.cpp, state for checkpoints in simulation_state.cpp.
#include "driver/simulation.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "driver/step_cost.hpp"
#include "particles/field_names.hpp"

namespace stirsph {

namespace {

/// Joules of a power per volume into the nodes of a mesh, each with the value at its place (second order in the edge
/// length, as the elements).
void add_node_source(RigidHeat& heat, double time, double dt, const input::Expression& value) {
  const HeatMesh& mesh = *heat.mesh;
  heat.node_input.resize(mesh.nodes(), 0.0);
  for (std::size_t n = 0; n < mesh.nodes(); ++n) {
    const Vec3& x = mesh.mesh().nodes[n];
    heat.node_input[n] += dt * mesh.node_volume(n) * value({time, x.x, x.y, x.z});
  }
}

/// The same of a power per area of some facets.
void add_surface_flux(RigidHeat& heat, const SurfaceScene& surface, double time, double dt) {
  const HeatMesh& mesh = *heat.mesh;
  heat.node_input.resize(mesh.nodes(), 0.0);
  const std::vector<double> area = mesh.lumped_area(chosen_facets(mesh.mesh(), surface));
  for (std::size_t n = 0; n < mesh.nodes(); ++n) {
    if (area[n] == 0) continue;
    const Vec3& x = mesh.mesh().nodes[n];
    heat.node_input[n] += dt * area[n] * (*surface.flux)({time, x.x, x.y, x.z});
  }
}

double total(const std::vector<double>& values) { return std::accumulate(values.begin(), values.end(), 0.0); }

}  // namespace

template <class Work>
void Simulation::guarded(Work&& work) {
  try {
    work();
  } catch (...) {
    if (!failure_) failure_ = std::current_exception();
  }
}

/// Runs a sweep while the halo copies it needs are on their way; the time it waits for them is not its own.
template <class Work>
void Simulation::sweep(const char* phase, Halo role, bool exchange, Work&& work) {
  const HaloExchange& halo = neighbourhood_->halo();
  if (exchange) {
    const ScopedTimer timer(timers_, "halo");
    halo.start(particles_, role);
  }
  const ScopedTimer timer(timers_, phase);
  work([&] {
    if (!exchange) return;
    const double begun = wall_seconds();
    halo.finish(particles_, role);
    const double waited = wall_seconds() - begun;
    timers_["halo"] += waited;
    timers_[phase] -= waited;
  });
}

/// One step: kick-drift-kick mechanics, then heat when it is due (first-order splitting). physics.md section 5.
void Simulation::step() {
  clock_.dt = clock_.next_dt;
  const double dt = clock_.dt;
  if (mechanics_) {
    kick(0.5 * dt);  // v at the middle of the step
    drift(dt);       // x at its end
    neighbourhood_->advance(dt);
    guarded([&] { move_rigids(dt); });

    if (list_expired_) renew_neighbours();  // brings the halo up to date
    guarded([&] {
      sweep("stress", Halo::Kinematic, !list_expired_,
            [&](const Arrival& halo) { mechanics_->update_stress(particles_, neighbourhood_->pairs(), dt, halo); });
    });
    list_expired_ = false;
    if (mechanics_->settings().hourglass_control > 0)
      sweep("hourglass", Halo::Gradient, true,
            [&](const Arrival& halo) { mechanics_->update_hourglass(particles_, neighbourhood_->pairs(), dt, halo); });
    if (contact_ && contact_->has_surface_layers())
      guarded([&] {
        const ScopedTimer timer(timers_, "contact");
        contact_->press(particles_, rigids_, dt, travel_of_contact(dt));
      });
    sweep("forces", Halo::Stress, true,
          [&](const Arrival& halo) { mechanics_->update_acceleration(particles_, neighbourhood_->pairs(), dt, halo); });
    guarded([&] { apply_loads(dt); });  // formulas of place and time may have no value at one rank's particles
    kick(0.5 * dt);
  }
  if (!mechanics_) guarded([&] { move_rigids(dt); });
  if (scene_.heat.mode != HeatScene::Mode::Off) advance_heat(dt);
  if (grains_) grains_->update(particles_, clock_.time, clock_.time + dt);
  clock_.time += dt;
  clock_.step += 1;
  list_upkeep_.steps += 1;
  look_at_inertia();
  vote();
}

void Simulation::solve_heat_now() {
  if (scene_.heat.mode != HeatScene::Mode::Conduction) return;
  conduct(std::max(time_since_heat_, clock_.dt));
  time_since_heat_ = 0;
}

bool Simulation::finished() const {
  // The last step is cut to end on time; what is left is round-off.
  return clock_.time >= scene_.time.end * (1 - 1e-12) ||
         (scene_.time.most_steps > 0 && clock_.step >= scene_.time.most_steps);
}

void Simulation::kick(double dt) {
  const ScopedTimer timer(timers_, "integration");
  for (int d = 0; d < particles_.layout().velocity_components; ++d) {
    double* v = particles_.component(field::velocity, d).data();
    const double* a = particles_.component(field::acceleration, d).data();
    for (std::size_t i = 0; i < particles_.owned(); ++i) v[i] += dt * a[i];
  }
}

void Simulation::drift(double dt) {
  const ScopedTimer timer(timers_, "integration");
  const Inertia& inertia = mechanics_->inertia();
  if (inertia.axisymmetric) {
    drift_rings(dt);
  } else if (!inertia.swirl) {
    drift_on_circles(dt);
  } else {
    for (int d = 0; d < particles_.layout().dim; ++d) {
      double* x = particles_.component(field::position, d).data();
      const double* v = particles_.component(field::velocity, d).data();
      for (std::size_t i = 0; i < particles_.owned(); ++i) x[i] += dt * v[i];
    }
  }
  bounce_off_planes();
}

/// What would pass its own mirror image in a plane of symmetry comes back.
void Simulation::bounce_off_planes() {
  for (int d = 0; d < particles_.layout().dim; ++d) {
    if (!scene_.domain.symmetric[d]) continue;
    double* x = particles_.component(field::position, d).data();
    double* v = particles_.component(field::velocity, particles_.layout().axes[d]).data();
    for (std::size_t i = 0; i < particles_.owned(); ++i)
      if (x[i] < scene_.domain.plane[d]) {
        x[i] = 2 * scene_.domain.plane[d] - x[i];
        v[i] = -v[i];
      }
  }
}

/// In the half-plane of r and z. With the swirl's inertia the angular momentum r v_theta stays (with the centrifugal
/// acceleration a symplectic step), without it v_theta does. No ring comes nearer to the axis than the core, where its
/// section and stresses no longer follow its radius and neighbours would not feel it: it bounces back, which keeps its
/// energy. (Rings let through to the axis pile up there and shoot along it.)
void Simulation::drift_rings(double dt) {
  double* r = particles_.component(field::position, 0).data();
  double* z = particles_.component(field::position, 1).data();
  double* radial = particles_.component(field::velocity, 0).data();
  double* swirl = particles_.component(field::velocity, 1).data();
  const double* axial = particles_.component(field::velocity, 2).data();
  const Inertia& inertia = mechanics_->inertia();
  for (std::size_t i = 0; i < particles_.owned(); ++i) {
    const double before = std::max(r[i], inertia.core);
    r[i] += dt * radial[i];
    z[i] += dt * axial[i];
    if (r[i] < inertia.core) {
      r[i] = 2 * inertia.core - r[i];
      radial[i] = -radial[i];
    }
    if (inertia.swirl) swirl[i] *= before / std::max(r[i], inertia.core);
  }
}

/// Three dimensions without inertia of the swirl: particles go along their circles around the z axis and their
/// velocities turn with them, so that no centripetal force is needed.
void Simulation::drift_on_circles(double dt) {
  const Inertia& inertia = mechanics_->inertia();
  std::array<double*, 3> x{}, v{};
  for (int d = 0; d < 3; ++d) {
    x[d] = particles_.component(field::position, d).data();
    v[d] = particles_.component(field::velocity, d).data();
  }
  for (std::size_t i = 0; i < particles_.owned(); ++i) {
    const double spin = inertia.spin({x[0][i], x[1][i], 0}, {v[0][i], v[1][i], 0});
    const double across = x[0][i] + dt * (v[0][i] + spin * x[1][i]), along = x[1][i] + dt * (v[1][i] - spin * x[0][i]);
    const double cosine = std::cos(spin * dt), sine = std::sin(spin * dt), vx = v[0][i], vy = v[1][i];
    x[0][i] = cosine * across - sine * along;
    x[1][i] = sine * across + cosine * along;
    x[2][i] += dt * v[2][i];
    v[0][i] = cosine * vx - sine * vy;
    v[1][i] = sine * vx + cosine * vy;
  }
}

/// The centrifugal acceleration of rings that have their swirl's inertia.
void Simulation::add_centrifugal(double dt) {
  const Inertia& inertia = mechanics_->inertia();
  if (!inertia.axisymmetric || !inertia.swirl) return;
  const double* r = particles_.component(field::position, 0).data();
  const double* swirl = particles_.component(field::velocity, 1).data();
  const double* swirl_rate = particles_.component(field::acceleration, 1).data();
  double* a = particles_.component(field::acceleration, 0).data();
  for (std::size_t i = 0; i < particles_.owned(); ++i) {
    const double now = swirl[i] + 0.5 * dt * swirl_rate[i];
    a[i] += now * now / std::max(r[i], inertia.core);
  }
}

void Simulation::move_rigids(double dt) {
  for (std::size_t r = 0; r < rigids_.size(); ++r) {
    try {
      motions_[r].advance(rigids_[r].pose, clock_.time, dt, rigid_force_[r]);
    } catch (const InputError& wrong) {  // a formula without a value at this time
      throw InputError("rigid \"" + rigids_[r].name + "\": " + wrong.what());
    }
  }
}

void Simulation::renew_neighbours() {
  const ScopedTimer timer(timers_, "neighbours");
  const double support = comm_.max(mechanics_ ? mechanics_->support(particles_)
                                              : scene_.numerics.h_over_dx * scene_.numerics.spacing *
                                                    kernel_support(scene_.numerics.kernel));
  bool repartition = false;
  std::vector<double> costs;
  if (comm_.size() > 1) {
    costs = particle_costs();
    repartition = repartition_rule_.asks(imbalance_of(comm_, total(costs)));
  }
  neighbourhood_->rebuild(particles_, support, repartition, costs);
  list_upkeep_.renewals += 1;
  list_upkeep_.repartitions += repartition;
  if (contact_) contact_->forget_candidates();
  collect_grip_members();
  measure_extent();
}

std::vector<double> Simulation::particle_costs() const {
  return stirsph::particle_costs(scene_, particles_, neighbourhood_->pairs(), contact_.get(), rigids_);
}

double Simulation::imbalance() const { return imbalance_of(comm_, total(particle_costs())); }

double Simulation::measured_imbalance() const {
  double own = 0;
  for (const auto& [phase, seconds] : timers_.seconds())
    if (phase == "stress" || phase == "forces" || phase == "contact") own += seconds;
  return imbalance_of(comm_, own);
}

double Simulation::renewal_cost() const {
  double lists = 0, rest = 0;
  for (const auto& [phase, seconds] : timers_.seconds()) (phase == "neighbours" ? lists : rest) += seconds;
  return list_upkeep_.renewals == 0
             ? 0.0
             : lists / static_cast<double>(list_upkeep_.renewals) / (rest / static_cast<double>(list_upkeep_.steps));
}

void Simulation::measure_extent() {
  std::array<const double*, 3> x{};
  for (int d = 0; d < particles_.layout().dim; ++d) x[d] = particles_.component(field::position, d).data();
  double farthest2 = 0;
  for (std::size_t i = 0; i < particles_.owned(); ++i) {
    double r2 = 0;
    for (int d = 0; d < particles_.layout().dim; ++d) r2 += x[d][i] * x[d][i];
    farthest2 = std::max(farthest2, r2);
  }
  farthest_ = std::sqrt(farthest2);
}

// Twice the last speed: accelerations within the step are small against it or the step size is wrong.
double Simulation::travel_of_contact(double dt) const { return dt * (2 * speed_ + surface_speed()); }

void Simulation::apply_loads(double dt) {
  const Inertia& inertia = mechanics_->inertia();
  add_centrifugal(dt);
  const auto& force = scene_.body_force;
  if (force[0] || force[1] || force[2]) {
    const ScopedTimer timer(timers_, "loads");
    for (int d = 0; d < particles_.layout().velocity_components; ++d) {
      if (!force[d]) continue;
      // The weight is physical: a scaled inertia must not make the load heavier.
      const double acceleration = (*force[d])({clock_.time + dt});
      double* a = particles_.component(field::acceleration, d).data();
      for (std::size_t i = 0; i < particles_.owned(); ++i) a[i] += acceleration / inertia.scale;
    }
  }
  if (contact_) {
    const ScopedTimer timer(timers_, "contact");
    contact_->apply(particles_, rigids_, dt, travel_of_contact(dt), particles_.has(field::heat_input));
  }
  if (!scene_.grips.empty()) {
    const ScopedTimer timer(timers_, "loads");
    apply_grips(dt);
  }
  // Work needs the velocity in the middle of the kick, which all forces together decide.
  for (int d = 0; d < particles_.layout().velocity_components; ++d) {
    if (!force[d]) continue;
    const double acceleration = (*force[d])({clock_.time + dt});
    const auto mass = particles_[field::mass];
    const double* a = particles_.component(field::acceleration, d).data();
    const double* v = particles_.component(field::velocity, d).data();
    for (std::size_t i = 0; i < particles_.owned(); ++i)
      load_ledger_.body_force += mass[i] * acceleration * (v[i] + 0.5 * dt * a[i]) * dt;
  }
}

/// Prescribed components get the acceleration that brings their velocity at the middle of the next step to the
/// prescribed one; the force this takes is the reaction.
void Simulation::apply_grips(double dt) {
  grip_loads_.assign(scene_.grips.size(), {});
  const Inertia& inertia = mechanics_->inertia();
  const int dim = particles_.layout().velocity_components;
  const double next_time = clock_.time + 1.5 * dt;
  for (std::size_t g = 0; g < scene_.grips.size(); ++g) {
    const GripScene& grip = scene_.grips[g];
    const double rate = grip.rotation ? grip.rotation->rate({next_time}) : 0.0;
    for (const std::int32_t i : grip_members_[g]) {
      const Vec3 x = particles_.vector_at(field::position, i), x0 = particles_.vector_at(field::initial_position, i);
      const Vec3 v = particles_.vector_at(field::velocity, i), a = particles_.vector_at(field::acceleration, i);
      Vec3 wanted = a;
      if (grip.rotation) {
        // The chord of the arc, so that the particle stays on its circle whatever the step.
        const Vec3 arm = x - grip.rotation->centre;
        const bool circles = inertia.axisymmetric || !inertia.swirl;  // the drift goes along the circle by itself
        const Vec3 chord =
            circles ? rate * dt * cross(grip.rotation->axis, arm) : rotated(arm, grip.rotation->axis, rate * dt) - arm;
        const Vec3 across = (chord / dt - v) / dt;
        const Vec3& axis = grip.rotation->axis;
        wanted = across - dot(across, axis) * axis + dot(a, axis) * axis;
      }
      for (int d = 0; d < dim; ++d)
        if (grip.velocity[d]) wanted[d] = ((*grip.velocity[d])({next_time, x0.x, x0.y, x0.z}) - v[d]) / dt;
      Vec3 reaction = particles_[field::mass][i] * inertia.momentum(x, wanted - a);
      for (int d = 0; d < dim; ++d) particles_.component(field::acceleration, d)[i] = wanted[d];
      load_ledger_.grips += dot(reaction, v + 0.5 * dt * wanted) * dt;
      Vec3 torque = cross(grip.rotation ? x - grip.rotation->centre : x, reaction);
      if (inertia.axisymmetric) reaction.x = reaction.y = torque.x = torque.y = 0;  // of the whole ring
      grip_loads_[g].force += reaction;
      grip_loads_[g].torque += torque;
    }
  }
}

void Simulation::advance_heat(double dt) {
  const ScopedTimer timer(timers_, "heat");
  time_since_heat_ += dt;
  if (scene_.heat.mode == HeatScene::Mode::Adiabatic) {
    absorb_heat_at_once();
    time_since_heat_ = 0;
  } else if ((clock_.step + 1) % scene_.heat.every == 0 || !mechanics_) {
    conduct(time_since_heat_);
    time_since_heat_ = 0;
  }
}

void Simulation::absorb_heat_at_once() {
  auto heat = particles_[field::heat_input], temperature = particles_[field::temperature];
  const auto mass = particles_[field::mass], material = particles_[field::material];
  for (std::size_t i = 0; i < particles_.owned(); ++i) {
    if (heat[i] == 0) continue;
    const auto& specific_heat = scene_.materials[static_cast<int>(material[i])].thermal.specific_heat;
    temperature[i] += heat[i] / (mass[i] * specific_heat(temperature[i]));
    heat[i] = 0;
  }
}

void Simulation::conduct(double dt) {
  const std::vector<InterfacePoint> points = interfaces_->take_points(particles_, rigids_, rigid_heat_, dt);
  ParticleFilm film;
  const bool free_surface = needs_free_surface();
  std::vector<double> free_area;
  if (free_surface) {
    free_area = heat_->free_surface(particles_, neighbourhood_->pairs(), points, rigids_);
    film.ambient_temperature = scene_.heat.ambient_temperature;
    for (const double area : free_area) film.conductance.push_back(scene_.heat.ambient_conductance * area);
  }
  comm_.together([&] { add_heat_sources(dt, free_area); });  // formulas may have no value at one rank's particles
  last_heat_ = heat_->advance(particles_, neighbourhood_->pairs(), neighbourhood_->halo(), points, rigid_heat_, dt,
                              free_surface ? &film : nullptr);
  heat_ledger_.particles += last_heat_.particle_heat;
  heat_ledger_.rigid += last_heat_.rigid_heat;
  heat_ledger_.source += last_heat_.source_heat;
  heat_ledger_.fixed += last_heat_.fixed_heat;
  heat_ledger_.ambient += last_heat_.ambient_heat;
  for (std::size_t r = 0; r < rigids_.size(); ++r) {
    BodyHeat& body = heat_ledger_.bodies[r];
    const BodyHeat& step = last_heat_.bodies[r];
    body.gained += step.gained;
    body.interface += step.interface;
    body.surface += step.surface;
    body.friction += step.friction;
  }
}

bool Simulation::needs_free_surface() const {
  return scene_.heat.ambient_conductance > 0 ||
         std::ranges::any_of(scene_.heat.sources, [](const HeatSourceScene& source) { return source.on_surface; });
}

/// Heat of the scene's own sources over the interval, at the time level of the fluxes.
void Simulation::add_heat_sources(double dt, const std::vector<double>& free_area) {
  const double level = clock_.time + clock_.dt - (scene_.heat.crank_nicolson ? 0.5 : 0.0) * dt;
  const auto body = particles_[field::body], volume = particles_[field::volume];
  auto input = particles_[field::heat_input];
  for (const HeatSourceScene& source : scene_.heat.sources) {
    for (std::size_t i = 0; i < particles_.owned(); ++i)
      if (source.bodies[static_cast<std::size_t>(body[i])]) {
        const Vec3 x = particles_.vector_at(field::position, i);
        const double amount = source.on_surface ? free_area[i] : volume[i];
        if (amount > 0) input[i] += dt * amount * source.value({level, x.x, x.y, x.z});
      }
    for (std::size_t r = 0; r < rigids_.size(); ++r)
      if (source.rigids[r]) add_node_source(rigid_heat_[r], level, dt, source.value);
  }
  for (std::size_t r = 0; r < rigids_.size(); ++r)
    if (rigid_heat_[r].mesh)
      for (const SurfaceScene& surface : scene_.rigids[r].heat.surfaces)
        if (surface.kind == SurfaceScene::Kind::Flux) add_surface_flux(rigid_heat_[r], surface, level, dt);
}

double HeatLedger::residual() const {
  const double given = particles + rigid + fixed + ambient;
  const double scale =
      std::max({std::abs(particles), std::abs(rigid), std::abs(fixed), std::abs(ambient), std::abs(source)});
  // Where nothing is hot the films exchange what rounding leaves of h (T - T_ambient).
  constexpr double noise = 1e-9;  // J
  return scale > noise ? (given - source) / scale : 0.0;
}

double Simulation::surface_speed() const {
  double fastest = 0;
  for (const RigidBody& rigid : rigids_) {
    const double radius = farthest_ + norm(rigid.pose.axis_point());
    // A round body that turns about its axis moves no point of its surface out of the half-plane's section.
    const double rotation = particles_.layout().axisymmetric() ? 0.0 : std::abs(rigid.pose.angular_velocity) * radius;
    fastest = std::max(fastest, norm(rigid.pose.velocity) + rotation);
  }
  return fastest;
}

/// dt = C min(h)/(c + |v|max) (paper eq. 20), or the fixed step; never past the end of the process.
double Simulation::stable_step() const {
  double dt = scene_.time.fixed_step;
  if (dt <= 0) {
    dt = scene_.time.cfl * least_h_ / (mechanics_->wave_speed() + speed_);
    // Particles that go along circles pass each other by far more than their relative motion in a plane.
    const Inertia& inertia = mechanics_->inertia();
    if (!inertia.swirl && !inertia.axisymmetric && speed_ > 0)
      dt = std::min(dt, scene_.limits.travel * scene_.numerics.spacing / speed_);
  }
  const double left = scene_.time.end - clock_.time;
  if (left <= 0) return dt;
  return left < dt * (1 + 1e-9) ? left : dt;
}

void Simulation::vote() {
  const ScopedTimer timer(timers_, "vote");
  StepVote& ballot = *vote_;
  ballot.clear();
  if (mechanics_) {
    guarded([&] {
      const ListMotion motion = neighbourhood_->motion(particles_, mechanics_->inertia());
      ballot[StepVote::Deviation] = motion.deviation;
      ballot[StepVote::RelativeSpeed] = motion.relative_speed;
      ballot[StepVote::Displacement] = motion.displacement;
      ballot[StepVote::Speed] = motion.speed;
      ballot[StepVote::Acceleration] = motion.acceleration;
      farthest_ = motion.extent;
      const double limit =
          scene_.limits.speed > 0 ? scene_.limits.speed : 10 * (mechanics_->wave_speed() + surface_speed());
      if (motion.finite && motion.speed <= limit) return;
      for (std::size_t i = 0; i < particles_.owned(); ++i) {
        const Vec3 velocity = particles_.vector_at(field::velocity, i);
        if (std::isfinite(dot(velocity, velocity)) && norm(velocity) <= limit) continue;
        const Vec3 x = particles_.vector_at(field::position, i);
        throw BlowUp("particle " + std::to_string(static_cast<std::int64_t>(particles_[field::id][i])) + " at (" +
                     std::to_string(x.x) + ", " + std::to_string(x.y) + ", " + std::to_string(x.z) +
                     ") m has the speed " + std::to_string(norm(velocity)) + " m/s, above the limit " +
                     std::to_string(limit) +
                     " m/s: the computation has become unstable. Take smaller steps (time.cfl, time.step), slow the "
                     "tool, add viscosity or "
                     "artificial stress, or raise limits.speed if the speed is real.");
      }
    });
    // A support that has grown since the list was built uses up the skin just as motion does.
    if (mechanics_->settings().variable_h) {
      const double grown =
          0.5 * std::max(0.0, mechanics_->support(particles_) + neighbourhood_->skin() - neighbourhood_->reach());
      ballot[StepVote::Deviation] += grown;
      ballot[StepVote::Displacement] += grown;
    }
    if (mechanics_->settings().variable_h || least_h_ == 0)
      ballot[StepVote::NegativeLength] = -mechanics_->least_smoothing_length(particles_);
  }
  if (contact_ && !contact_->loads().empty())
    for (std::size_t r = 0; r < rigids_.size(); ++r) {
      const ContactLoad& load = contact_->loads()[r];
      for (int d = 0; d < 3; ++d) {
        ballot.sum(6 * r + d) = load.force[d];
        ballot.sum(6 * r + 3 + d) = load.torque[d];
      }
      ballot[StepVote::Penetration] = std::max(ballot[StepVote::Penetration], load.penetration);
    }
  ballot[StepVote::Failure] = failure_ ? 1 : 0;
  ballot[StepVote::Stop] = requests.stop;
  ballot[StepVote::WriteProgress] = requests.progress;
  ballot[StepVote::WriteCheckpoint] = requests.checkpoint;
  ballot.take();

  if (ballot[StepVote::Failure] > 0) comm_.throw_together(std::exchange(failure_, nullptr));
  requests = {ballot[StepVote::Stop] > 0, ballot[StepVote::WriteProgress] > 0, ballot[StepVote::WriteCheckpoint] > 0};
  speed_ = ballot[StepVote::Speed];
  penetration_ = ballot[StepVote::Penetration];
  if (ballot[StepVote::NegativeLength] > -std::numeric_limits<double>::infinity())
    least_h_ = -ballot[StepVote::NegativeLength];
  for (std::size_t r = 0; r < rigids_.size(); ++r)
    for (int d = 0; d < 3; ++d) {
      rigid_force_[r][d] = ballot.sum(6 * r + d);
      rigid_torque_[r][d] = ballot.sum(6 * r + 3 + d);
    }
  if (penetration_ > scene_.limits.penetration * scene_.numerics.spacing)
    throw BlowUp("a particle has penetrated a rigid body by " + std::to_string(penetration_ / scene_.numerics.spacing) +
                 " spacings (limits.penetration): contact is lost. Raise penalty_scale or soft_scale, or take smaller "
                 "steps (time.cfl, time.step).");
  clock_.next_dt = stable_step();
  const ListMotion motion{ballot[StepVote::Deviation], ballot[StepVote::RelativeSpeed], ballot[StepVote::Displacement],
                          ballot[StepVote::Speed], ballot[StepVote::Acceleration]};
  list_expired_ = mechanics_ && !neighbourhood_->holds(motion, clock_.next_dt);
}

}  // namespace stirsph
