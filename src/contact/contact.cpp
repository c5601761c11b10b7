#include "contact/contact.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "particles/field_names.hpp"

namespace stirsph {

Contact::Contact(std::vector<ContactPair> pairs, int dim, double spacing, std::vector<double> moduli,
                 const Inertia& inertia)
    : pairs_(std::move(pairs)),
      dim_(dim),
      spacing_(spacing),
      moduli_(std::move(moduli)),
      inertia_(inertia),
      candidates_(pairs_.size()) {}

double Contact::area_of(double volume, double radius) const {
  if (!inertia_.axisymmetric) return dim_ == 3 ? std::cbrt(volume * volume) : std::sqrt(volume);
  const double circumference = 2 * std::numbers::pi * std::max(radius, inertia_.core);
  return circumference * std::sqrt(volume / circumference);
}

/// Friction [N] against a slip [m/s] that all other forces would leave at the end of the kick. Sticking is what would
/// bring it to rest there: friction never reverses the slip and a held particle does not creep, also where inertia
/// depends on the direction.
Vec3 Contact::friction_on(const Vec3& x, const Vec3& slip, double mass, double limit, double dt) const {
  const Vec3 sticking = inertia_.momentum(x, slip) * (-mass / dt);
  const double speed = norm(slip);
  if (norm(sticking) <= limit) return sticking;
  if (!inertia_.directional()) return slip * (-limit / speed);
  const Vec3 swirl = inertia_.swirl_part(x, slip);
  const double per_speed = std::min(limit / speed, mass * inertia_.scale / dt),
               per_swirl = std::min(limit / speed, mass * inertia_.swirl_scale() / dt);
  return -per_speed * (slip - swirl) - per_swirl * swirl;
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
  const double reach = 0.5 * spacing_ + margin();
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

void Contact::apply(ParticleSet& particles, const std::vector<RigidBody>& bodies, double dt, double travel,
                    bool heat_input) {
  contact_step_ = std::max(contact_step_, dt);
  budget_ -= travel;
  if (!candidates_valid_ || budget_ <= 0) {
    candidates_ = search(particles, bodies);
    candidates_valid_ = true;
    searches_ += 1;
    budget_ = margin();
  }
  loads_.assign(bodies.size(), {});

  std::array<double*, 3> a{}, v{};
  const int components = particles.layout().velocity_components;
  for (int d = 0; d < components; ++d) {
    a[d] = particles.component(field::acceleration, d).data();
    v[d] = particles.component(field::velocity, d).data();
  }
  const double* mass = particles[field::mass].data();
  const double* volume = particles[field::volume].data();
  const double* strength = particles[field::flow_stress].data();
  const double* material_of = particles[field::material].data();
  double* heat_field = heat_input ? particles[field::heat_input].data() : nullptr;

  for (std::size_t p = 0; p < pairs_.size(); ++p) {
    const ContactPair& pair = pairs_[p];
    const RigidBody& rigid = bodies[pair.rigid];
    const PlacedBody placed(rigid);
    ContactLoad& load = loads_[pair.rigid];
    const auto own_component = [&](const FieldInfo& info) {
      return pair.heat_component >= 0 && particles.has(info) ? particles.component(info, pair.heat_component).data()
                                                             : nullptr;
    };
    double* const body_heat = own_component(field::rigid_heat);
    double* const impulse = own_component(field::rigid_impulse);
    for (const std::int32_t i : candidates_[p]) {
      const Vec3 x = particles.vector_at(field::position, i);
      const SurfacePoint surface = placed.nearest(x);
      const double depth = 0.5 * spacing_ - surface.distance;
      if (depth <= 0) continue;
      const Vec3 n = surface.normal;
      const int material = static_cast<int>(material_of[i]);
      const double inertia = mass[i] * inertia_.scale, area = area_of(volume[i], x.x);
      const double stiffness = std::max(pair.penalty_scale * moduli_[material] * area / spacing_,
                                        pair.soft_scale * inertia / (contact_step_ * contact_step_));
      Vec3 half_velocity, acceleration;
      for (int d = 0; d < components; ++d) {
        half_velocity[d] = v[d][i];
        acceleration[d] = a[d][i];
      }
      const Vec3 surface_velocity = rigid.pose.velocity_at(x);
      const double opening = dot(half_velocity - surface_velocity, n);
      const double normal_force =
          std::max(0.0, stiffness * depth - 2 * pair.damping * std::sqrt(stiffness * inertia) * opening);

      const Vec3 coming = half_velocity + dt * acceleration - surface_velocity;
      const Vec3 slip = coming - dot(coming, n) * n;
      const double cap =
          pair.shear_limit >= 0 ? pair.shear_limit : pair.shear_limit_factor * strength[i] * std::numbers::inv_sqrt3;
      const Vec3 friction = friction_on(x, slip, mass[i], std::min(pair.friction * normal_force, cap * area), dt);
      const Vec3 force = normal_force * n + friction, added = inertia_.acceleration(x, force / mass[i]);
      for (int d = 0; d < components; ++d) a[d][i] += added[d];

      // Work over the kick: force times the mean of the velocities before and after it.
      const Vec3 mean = half_velocity + 0.5 * dt * (acceleration + added) - surface_velocity;
      const Vec3 tangential = mean - dot(mean, n) * n;
      const double friction_power = -dot(friction, tangential);
      ledger_.external += dot(force, surface_velocity) * dt;
      ledger_.friction += friction_power * dt;
      ledger_.normal -= normal_force * dot(mean, n) * dt;

      Vec3 torque = cross(x - rigid.pose.axis_point(), force), resultant = force;
      if (inertia_.axisymmetric) resultant.x = resultant.y = torque.x = torque.y = 0;  // of the whole ring
      load.force -= resultant;
      load.torque -= torque;
      load.friction_power += friction_power;
      load.sliding_speed += norm(tangential);
      load.surface_speed += norm(surface_velocity - dot(surface_velocity, n) * n);
      load.area += area;
      load.normal_force += normal_force;
      load.penetration = std::max(load.penetration, depth);
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
