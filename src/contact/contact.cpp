#include "contact/contact.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "particles/field_names.hpp"

namespace stirsph {

namespace {

/// A ring's velocity or force with another swirl component.
Vec3 with_swirl(const Vec3& v, double factor) { return {v.x, v.y * factor, v.z}; }

}  // namespace

Contact::Contact(std::vector<ContactPair> pairs, const SpaceLayout& layout, double spacing,
                 std::vector<ContactMaterial> materials, const Inertia& inertia, bool surface_layers)
    : pairs_(std::move(pairs)),
      dim_(layout.dim),
      spacing_(spacing),
      materials_(std::move(materials)),
      inertia_(inertia),
      candidates_(pairs_.size()),
      touches_(pairs_.size()) {
  if (surface_layers) layer_.emplace(layout, spacing);
}

double Contact::area_of(double volume, double radius) const {
  if (!inertia_.axisymmetric) return dim_ == 3 ? std::cbrt(volume * volume) : std::sqrt(volume);
  const double circumference = 2 * std::numbers::pi * std::max(radius, inertia_.core);
  return circumference * std::sqrt(volume / circumference);
}

double Contact::lever(const Touch& touch) const {
  const double radius = touch.position.x;
  if (!inertia_.axisymmetric || radius < inertia_.core) return 1;
  return (radius - touch.distance * touch.normal.x) / radius;
}

Vec3 Contact::sticking(const Vec3& x, const Vec3& slip, double lever, double mass, double dt) const {
  return with_swirl(inertia_.momentum(x, with_swirl(slip, 1 / lever)), 1 / lever) * (-mass / dt);
}

Vec3 Contact::sliding(const Vec3& x, const Vec3& slip, double lever, double mass, double limit, double dt) const {
  const double speed = norm(slip);
  if (!inertia_.directional() && lever == 1) return slip * (-limit / speed);
  const Vec3 swirl = inertia_.swirl_part(x, slip);
  const double per_speed = std::min(limit / speed, mass * inertia_.scale / dt),
               per_swirl = std::min(limit / speed, mass * inertia_.swirl_scale() / (lever * lever * dt));
  return -per_speed * (slip - swirl) - per_swirl * swirl;
}

double Contact::shear_limit(const ContactPair& pair, const ParticleSet& particles, std::size_t i, double area,
                            double coulomb, double slip, double stopping) const {
  if (pair.shear_limit >= 0) return std::min(coulomb, area * pair.shear_limit);
  const double per_stress = area * pair.shear_limit_factor * std::numbers::inv_sqrt3;
  const double strength = per_stress * particles[field::flow_stress][i];
  const FlowStress* flow = materials_[static_cast<int>(particles[field::material][i])].flow.get();
  if (coulomb <= strength || stopping <= strength || !flow) return std::min(coulomb, strength);
  const auto at_slip = [&](double speed) {
    const double rate = speed / spacing_ * std::numbers::inv_sqrt3;
    return std::max(strength, per_stress * flow->value(particles[field::equivalent_plastic_strain][i], rate,
                                                       particles[field::temperature][i]));
  };
  // The slip that is left after the kick, u = slip (1 - force/stopping), by the secant in a bracket (Illinois).
  double low = 0, high = slip, at_low = strength - stopping, at_high = at_slip(slip), force = at_high;
  int last = 0;
  for (int iteration = 0; iteration < 50 && high - low > 1e-15 * slip; ++iteration) {
    const double u = (low * at_high - high * at_low) / (at_high - at_low);
    force = at_slip(u);
    const double excess = force - stopping * (1 - u / slip);
    if (std::abs(excess) <= 1e-14 * stopping) break;
    const int side = excess > 0 ? 1 : -1;
    (excess > 0 ? high : low) = u;
    (excess > 0 ? at_high : at_low) = excess;
    if (side == last) (excess > 0 ? at_low : at_high) *= 0.5;
    last = side;
  }
  return std::min(coulomb, force);
}

namespace {

/// A ball around consecutive particles, which are neighbours in space.
struct Ball {
  Vec3 centre;
  double radius = 0;
};
Ball ball_around(const ParticleSet& particles, std::size_t first, std::size_t last) {
  Ball ball;
  for (std::size_t i = first; i < last; ++i) ball.centre += particles.vector_at(field::position, i);
  ball.centre = ball.centre / static_cast<double>(last - first);
  for (std::size_t i = first; i < last; ++i)
    ball.radius = std::max(ball.radius, norm(particles.vector_at(field::position, i) - ball.centre));
  return ball;
}

}  // namespace

// A whole spacing of margin: a candidate list lives for several steps even under a fast rim.
double Contact::margin() const { return spacing_; }

std::vector<std::vector<std::int32_t>> Contact::search(const ParticleSet& particles,
                                                       const std::vector<RigidBody>& bodies) const {
  const double reach = largest_distance() + margin();
  std::vector<std::vector<std::int32_t>> candidates(pairs_.size());
  const auto body_of = particles[field::body];
  std::vector<PlacedBody> placed;
  for (const ContactPair& pair : pairs_) placed.emplace_back(bodies[pair.rigid]);
  for (std::size_t first = 0; first < particles.owned(); first += cluster_size) {
    const std::size_t last = std::min(first + cluster_size, particles.owned());
    const Ball ball = ball_around(particles, first, last);
    for (std::size_t p = 0; p < pairs_.size(); ++p) {
      // A distance changes by no more than one goes: most clusters are told by one look.
      if (placed[p].nearest(ball.centre).distance >= ball.radius + reach) continue;
      for (std::size_t i = first; i < last; ++i)
        if (pairs_[p].bodies[static_cast<int>(body_of[i])] &&
            placed[p].nearest(particles.vector_at(field::position, i)).distance < reach)
          candidates[p].push_back(static_cast<std::int32_t>(i));
    }
  }
  return candidates;
}

void Contact::renew_candidates(const ParticleSet& particles, const std::vector<RigidBody>& bodies, double travel) {
  budget_ -= travel;
  if (candidates_valid_ && budget_ > 0) return;
  candidates_ = search(particles, bodies);
  candidates_valid_ = true;
  searches_ += 1;
  budget_ = margin();
}

void Contact::find_touches(ParticleSet& particles, const std::vector<RigidBody>& bodies, double dt, double travel,
                           const LayerArrays* layers) {
  contact_step_ = std::max(contact_step_, dt);
  renew_candidates(particles, bodies, travel);
  const double* const volume = particles[field::volume].data();
  const double* const mass = particles[field::mass].data();
  const double* const material = particles[field::material].data();
  for (std::size_t p = 0; p < pairs_.size(); ++p) {
    const ContactPair& pair = pairs_[p];
    const RigidPose& pose = bodies[pair.rigid].pose;
    const PlacedBody placed(bodies[pair.rigid]);
    touches_[p].clear();
    for (const std::int32_t i : candidates_[p]) {
      Touch touch;
      touch.particle = i;
      touch.position = particles.vector_at(field::position, i);
      const SurfacePoint surface = placed.nearest(touch.position);
      touch.normal = surface.normal;
      touch.distance = surface.distance;
      touch.thickness = layers ? layer_->thickness(*layers, i, touch.normal) : 0.5 * spacing_;
      if (touch.depth() <= 0) continue;
      touch.foot = inertia_.axisymmetric ? touch.position - touch.distance * touch.normal : touch.position;
      touch.surface_velocity = pose.velocity_at(touch.foot);
      touch.area = layers ? volume[i] / (2 * touch.thickness) : area_of(volume[i], touch.position.x);
      const ContactMaterial& metal = materials_[static_cast<std::size_t>(material[i])];
      const double inertia = mass[i] * inertia_.scale;
      const double stiffness = std::max(pair.penalty_scale * metal.youngs_modulus * touch.area / spacing_,
                                        pair.soft_scale * inertia / (contact_step_ * contact_step_)),
                   damping = 2 * pair.damping * std::sqrt(stiffness * inertia);
      // The particle's surface moves away from the body as its centre does, less what its layer opens.
      double opening = dot(particles.vector_at(field::velocity, i) - touch.surface_velocity, touch.normal);
      if (layers) opening -= layer_->opening(*layers, i, touch.normal, touch.thickness);
      touch.force = std::max(0.0, stiffness * touch.depth() - damping * opening);
      touches_[p].push_back(touch);
    }
  }
}

void Contact::press(ParticleSet& particles, const std::vector<RigidBody>& bodies, double dt, double travel) {
  const LayerArrays arrays = layer_->arrays(particles);
  // The layers' stress of a step acts while the velocity goes from its half to the next: their work is that at the mean
  // of the two gradients, and this is the second of those of the step before.
  ledger_.normal += 0.5 * dt * layer_->power(arrays);
  layer_->unload(arrays);
  layer_->advance(arrays, dt);
  find_touches(particles, bodies, dt, travel, &arrays);
  for (const std::vector<Touch>& touches : touches_)
    for (const Touch& touch : touches) layer_->load(arrays, touch.particle, touch.normal, touch.thickness, touch.force);
  ledger_.normal += 0.5 * dt * layer_->power(arrays);
}

void Contact::apply(ParticleSet& particles, const std::vector<RigidBody>& bodies, double dt, double travel,
                    bool heat_input) {
  if (!layer_) find_touches(particles, bodies, dt, travel, nullptr);
  loads_.assign(bodies.size(), {});

  std::array<double*, 3> a{}, v{};
  const int components = particles.layout().velocity_components;
  for (int d = 0; d < components; ++d) {
    a[d] = particles.component(field::acceleration, d).data();
    v[d] = particles.component(field::velocity, d).data();
  }
  std::array<double*, 3> traction{};
  if (particles.has(field::contact_traction))
    for (int d = 0; d < components; ++d) {
      const auto component = particles.component(field::contact_traction, d);
      std::fill(component.begin(), component.end(), 0.0);
      traction[d] = component.data();
    }
  const double* mass = particles[field::mass].data();
  const double* material_of = particles[field::material].data();
  double* heat_field = heat_input ? particles[field::heat_input].data() : nullptr;

  for (std::size_t p = 0; p < pairs_.size(); ++p) {
    const ContactPair& pair = pairs_[p];
    const RigidBody& rigid = bodies[pair.rigid];
    ContactLoad& load = loads_[pair.rigid];
    const auto own_component = [&](const FieldInfo& info) {
      return pair.heat_component >= 0 && particles.has(info) ? particles.component(info, pair.heat_component).data()
                                                             : nullptr;
    };
    double* const body_heat = own_component(field::rigid_heat);
    double* const impulse = own_component(field::rigid_impulse);
    for (const Touch& touch : touches_[p]) {
      const std::int32_t i = touch.particle;
      const Vec3 &x = touch.position, &n = touch.normal, &surface_velocity = touch.surface_velocity;
      const int material = static_cast<int>(material_of[i]);
      const double arm = lever(touch), normal_force = touch.force;
      Vec3 half_velocity, acceleration;
      for (int d = 0; d < components; ++d) {
        half_velocity[d] = v[d][i];
        acceleration[d] = a[d][i];
      }
      half_velocity = with_swirl(half_velocity, arm);  // of the particle's metal at the surface
      acceleration = with_swirl(acceleration, arm);
      const Vec3 coming = half_velocity + dt * acceleration - surface_velocity;
      const Vec3 slip = coming - dot(coming, n) * n;
      const double touching = touch.area * arm;
      const Vec3 stopping = sticking(x, slip, arm, mass[i], dt);
      const double limit =
          shear_limit(pair, particles, i, touching, pair.friction * normal_force, norm(slip), norm(stopping));
      const Vec3 friction = norm(stopping) <= limit ? stopping : sliding(x, slip, arm, mass[i], limit, dt);
      const Vec3 force = normal_force * n + friction,
                 added = inertia_.acceleration(x, with_swirl(force, arm) / mass[i]);
      for (int d = 0; d < components; ++d) a[d][i] += added[d];
      if (traction[0])
        for (int d = 0; d < components; ++d) traction[d][i] += force[d] / touching;

      // Work over the kick: force times the mean of the velocities before and after it.
      const Vec3 mean = half_velocity + 0.5 * dt * (acceleration + with_swirl(added, arm)) - surface_velocity;
      const Vec3 tangential = mean - dot(mean, n) * n;
      const double friction_power = -dot(friction, tangential);
      ledger_.external += dot(force, surface_velocity) * dt;
      ledger_.friction += friction_power * dt;
      ledger_.normal -= normal_force * dot(mean, n) * dt;

      Vec3 torque = cross(touch.foot - rigid.pose.axis_point(), force), resultant = force;
      if (inertia_.axisymmetric) resultant.x = resultant.y = torque.x = torque.y = 0;  // of the whole ring
      load.force -= resultant;
      load.torque -= torque;
      load.friction_power += friction_power;
      load.sliding_speed += norm(tangential);
      load.surface_speed += norm(surface_velocity - dot(surface_velocity, n) * n);
      load.area += touching;
      load.normal_force += normal_force;
      load.penetration = std::max(load.penetration, touch.depth());
      const double heat = pair.heat_conversion * friction_power * dt;
      const double share = pair.heat_share.empty() ? 1.0 : pair.heat_share[material];
      if (heat_field) {
        heat_field[i] += share * heat;
        ledger_.friction_heat += share * heat;
      }
      load.heat += (1 - share) * heat;
      if (body_heat) body_heat[i] += (1 - share) * heat;
      if (impulse) impulse[i] += normal_force * dt;
    }
  }
}

std::vector<Contact::Overlap> Contact::overlaps(const ParticleSet& particles,
                                                const std::vector<RigidBody>& bodies) const {
  std::vector<Overlap> result(pairs_.size());
  const auto body_of = particles[field::body];
  for (std::size_t p = 0; p < pairs_.size(); ++p)
    for (std::size_t i = 0; i < particles.owned(); ++i) {
      if (!pairs_[p].bodies[static_cast<int>(body_of[i])]) continue;
      const Vec3 x = particles.vector_at(field::position, i);
      const double depth = 0.5 * spacing_ - bodies[pairs_[p].rigid].nearest(x).distance;
      if (depth > result[p].depth) result[p] = {depth, static_cast<std::int64_t>(particles[field::id][i]), x};
    }
  return result;
}

}  // namespace stirsph
