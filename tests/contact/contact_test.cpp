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
  explicit Touching(const ContactPair& settings, double strength, double z_velocity = 0,
                    std::shared_ptr<const FlowStress> flow = nullptr, double step = dt)
      : contact({settings}, layout_of(Cartesian3{}), spacing, {{modulus, std::move(flow)}}, Inertia{}) {
    for (const FieldInfo* info : {&field::id, &field::body, &field::material, &field::mass, &field::position,
                                  &field::velocity, &field::acceleration, &field::volume, &field::flow_stress,
                                  &field::heat_input, &field::equivalent_plastic_strain, &field::temperature})
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
    contact.apply(particles, bodies, step, 0, true);
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

/// sigma_y = 1e8 Pa (1 + 0.1 ln(rate / 1/s)).
struct RateSensitive final : FlowStress {
  long return_map(const FlowBatch& /*batch*/) const override { return 0; }
  bool rate_sensitive() const override { return true; }
  double value(double /*plastic_strain*/, double rate, double /*temperature*/) const override {
    return 1e8 * (1 + 0.1 * std::log(std::max(1.0, rate)));
  }
};

/// The surface bears what a layer of one spacing bears that shears with the slip left after the kick.
TEST(Contact, ShearStrengthIsThatOfALayerThatSlips) {
  const Touching one(pair_with(0.3), 1e8, 0, std::make_shared<RateSensitive>(), 5e-8);
  const double friction = mass * one.particles.component(field::acceleration, 1)[0];
  const double left = slip - friction / mass * 5e-8, rate = left / spacing * std::numbers::inv_sqrt3;
  ASSERT_GT(left, 0.05 * slip);
  ASSERT_LT(left, 0.7 * slip);
  EXPECT_NEAR(friction, 1e8 * (1 + 0.1 * std::log(rate)) * std::numbers::inv_sqrt3 * spacing * spacing,
              1e-6 * friction);
}

/// A ring in a turning bore: the friction stress acts on the area of the bore and with its arm, and what it does on the
/// ring is the torque over the ring's own radius.
TEST(Contact, FrictionOnARingHasTheArmOfTheSurface) {
  constexpr double centre = 4e-3, bore = centre + 0.5 * spacing - depth, height = 1e-3;
  ParticleSet particles{layout_of(AxisymmetricSwirl{})};
  for (const FieldInfo* info : {&field::id, &field::body, &field::material, &field::mass, &field::position,
                                &field::velocity, &field::acceleration, &field::volume, &field::flow_stress})
    particles.add(*info);
  particles.resize_owned(1);
  particles[field::mass][0] = mass;
  particles[field::volume][0] = 2 * std::numbers::pi * centre * spacing * height;
  particles[field::flow_stress][0] = 1e8;
  particles.component(field::position, 0)[0] = centre;
  Inertia inertia;
  inertia.axisymmetric = true;
  Contact contact({pair_with(10)}, layout_of(AxisymmetricSwirl{}), spacing, {{modulus, nullptr}}, inertia);
  const ShapePointer shape = make_annulus({0, 0, -1}, {0, 0, 1}, bore, 0.02, 2);
  std::vector<RigidBody> bodies{{"die", shape, {}}};
  bodies[0].pose.angular_velocity = 1e3;
  contact.apply(particles, bodies, 1e-9, 0, false);
  const double torque = 1e8 * std::numbers::inv_sqrt3 * 2 * std::numbers::pi * bore * height * bore;
  const ContactLoad& load = contact.loads()[0];
  EXPECT_NEAR(load.torque.z, -torque, 1e-9 * torque);
  EXPECT_NEAR(load.area, 2 * std::numbers::pi * bore * height, 1e-15);
  EXPECT_NEAR(mass * particles.component(field::acceleration, 1)[0] * centre, torque, 1e-9 * torque);
  const double after = particles.component(field::acceleration, 1)[0] * 1e-9 / centre;  // 1/s
  EXPECT_NEAR(contact.ledger().friction, torque * (1e3 - 0.5 * after) * 1e-9, 1e-9 * torque * 1e3 * 1e-9);
}

TEST(Contact, DampingNeverPulls) {
  ContactPair pair = pair_with(0);
  pair.damping = 1;
  const Touching leaving(pair, 1e30, 1e4);
  EXPECT_EQ(leaving.particles.component(field::acceleration, 2)[0], 0.0);
}

}  // namespace
}  // namespace stirsph
