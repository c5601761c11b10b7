/// One particle at a turning plane: each number of the contact law by hand.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <numbers>

#include "contact/contact.hpp"
#include "geometry/primitives.hpp"
#include "particles/field_names.hpp"

namespace stirsph {
namespace {

constexpr double spacing = 1e-3, mass = 2e-6, modulus = 70e9, dt = 1e-8, depth = 0.1e-3, slip = 5;

/// A particle on the x axis that touches a plane z = 0 from above; the plane turns about z.
struct Touching {
  explicit Touching(const ContactPair& settings, double strength, double z_velocity = 0)
      : contact({settings}, 3, spacing, {modulus}, Inertia{}) {
    for (const FieldInfo* info :
         {&field::id, &field::body, &field::material, &field::mass, &field::position, &field::velocity,
          &field::acceleration, &field::volume, &field::flow_stress, &field::heat_input})
      particles.add(*info);
    particles.add(field::rigid_heat, 2);
    particles.add(field::rigid_impulse, 2);
    particles.resize_owned(1);
    particles[field::mass][0] = mass;
    particles[field::volume][0] = spacing * spacing * spacing;
    particles[field::flow_stress][0] = strength;
    particles.component(field::position, 0)[0] = 4e-3;
    particles.component(field::position, 2)[0] = 0.5 * spacing - depth;
    particles.component(field::velocity, 2)[0] = z_velocity;
    bodies.push_back({"plane", std::make_shared<HalfSpace>(Vec3{}, Vec3{0, 0, 1}), {}});
    bodies[0].pose.angular_velocity = slip / 4e-3;  // the surface moves along y
    contact.apply(particles, bodies, dt, 0, true);
  }
  ParticleSet particles{layout_of(Cartesian3{})};
  std::vector<RigidBody> bodies;
  Contact contact;
};

ContactPair pair_with(double friction) {
  ContactPair pair;
  pair.bodies = {true};
  pair.friction = friction;
  pair.soft_scale = 0;
  pair.heat_share = {0.7};
  pair.heat_component = 1;
  return pair;
}

TEST(Contact, CoulombFrictionForceTorqueWorkAndHeat) {
  const double normal = 0.1 * modulus * spacing * depth, friction = 0.3 * normal;
  const Touching one(pair_with(0.3), 1e30);
  EXPECT_NEAR(mass * one.particles.component(field::acceleration, 2)[0], normal, 1e-9 * normal);
  EXPECT_NEAR(mass * one.particles.component(field::acceleration, 1)[0], friction, 1e-9 * friction);  // dragged along
  const ContactLoad& load = one.contact.loads()[0];
  EXPECT_NEAR(load.force.z, -normal, 1e-9 * normal);
  EXPECT_NEAR(load.torque.z, -4e-3 * friction, 4e-12 * friction);  // brakes the body
  const double mean_slip = slip - 0.5 * dt * friction / mass;
  EXPECT_NEAR(load.friction_power, friction * mean_slip, 1e-9 * friction * slip);
  const ContactLedger& ledger = one.contact.ledger();
  EXPECT_NEAR(ledger.friction, friction * mean_slip * dt, 1e-9 * friction * slip * dt);
  EXPECT_NEAR(ledger.external, friction * slip * dt, 1e-9 * friction * slip * dt);
  const double heat = 0.9 * friction * mean_slip * dt;
  EXPECT_NEAR(one.particles[field::heat_input][0], 0.7 * heat, 1e-9 * heat);
  EXPECT_NEAR(ledger.friction_heat, 0.7 * heat, 1e-9 * heat);
  EXPECT_NEAR(load.heat, 0.3 * heat, 1e-9 * heat);
  EXPECT_NEAR(one.particles.component(field::rigid_heat, 1)[0], 0.3 * heat, 1e-9 * heat);
  EXPECT_EQ(one.particles.component(field::rigid_heat, 0)[0], 0);  // another body's
  EXPECT_NEAR(one.particles.component(field::rigid_impulse, 1)[0], normal * dt, 1e-9 * normal * dt);
}

TEST(Contact, FrictionIsLimitedByTheShearStrength) {
  const Touching one(pair_with(0.3), 1e8);
  const double friction = 1e8 * std::numbers::inv_sqrt3 * spacing * spacing;
  EXPECT_NEAR(mass * one.particles.component(field::acceleration, 1)[0], friction, 1e-9 * friction);
}

TEST(Contact, DampingNeverPulls) {
  ContactPair pair = pair_with(0);
  pair.damping = 1;
  const Touching leaving(pair, 1e30, 1e4);
  EXPECT_EQ(leaving.particles.component(field::acceleration, 2)[0], 0.0);
}

}  // namespace
}  // namespace stirsph
