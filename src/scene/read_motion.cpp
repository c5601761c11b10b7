#include "scene/read_motion.hpp"

#include <cmath>

namespace stirsph {

using input::Parameters;

std::array<OptionalExpression, 3> vector_expression(const Parameters& p, const std::string& key) {
  std::array<OptionalExpression, 3> result;
  if (!p.has(key)) return result;
  const Parameters table = p.table(key);
  const char* names[] = {"x", "y", "z"};
  for (int d = 0; d < 3; ++d)
    if (table.has(names[d])) result[d] = table.expression(names[d]);
  return result;
}

Vec3 unit_vector(const Parameters& p, const std::string& key) {
  const Vec3 v = p.vector(key);
  if (norm(v) == 0) p.fail(key, "a direction must not be the zero vector.");
  return normalised(v);
}

std::optional<RotationScene> rotation_of(const Parameters& p) {
  if (!p.has("rotation")) return std::nullopt;
  const Parameters r = p.table("rotation");
  return RotationScene{r.vector("centre"), unit_vector(r, "axis"), r.expression("rate")};
}

namespace {

ForceScene read_force(const Parameters& m) {
  ForceScene force;
  force.preload = m.real("preload");
  force.approach_time = m.real("approach_time");
  if (m.has("approach_speed")) force.approach_speed = m.real("approach_speed");
  force.dwell = m.real("dwell");
  force.ramp_rate = m.real("ramp_rate");
  force.target = m.real("target");
  force.velocity_limit = m.real("velocity_limit");
  force.withdrawal_limit = m.has("withdrawal_limit") ? m.real("withdrawal_limit") : force.velocity_limit;
  if (m.has("stroke_limit")) force.stroke_limit = m.real("stroke_limit");
  if (m.has("stiffness")) force.stiffness = m.real("stiffness");
  force.bandwidth = m.real("bandwidth");
  if (force.target < force.preload) m.fail("target", "the target force must not be below the preload.");
  return force;
}

RetreatScene read_retreat(const Parameters& r, const MotionScene& motion) {
  RetreatScene retreat;
  if (r.has("at") == r.has("dwell"))
    r.fail("at", "give one of at (a process time) and dwell (after the end of the table or of the force programme).");
  if (r.has("at")) retreat.at = r.real("at");
  if (r.has("dwell")) {
    if (motion.kind != MotionScene::Kind::Displacement && motion.kind != MotionScene::Kind::Force)
      r.fail("dwell", "this motion has no end after which to dwell: give at, such as at = \"40 s\".");
    retreat.dwell = r.real("dwell");
  }
  retreat.speed = r.real("speed");
  retreat.distance = r.real("distance");
  retreat.direction = r.has("direction") ? unit_vector(r, "direction") : -motion.direction;
  retreat.stop_rotation = r.boolean("stop_rotation");
  return retreat;
}

MotionScene read_translation(const Parameters& m) {
  MotionScene motion;
  const std::string& type = m.text("type");
  if (type == "velocity") {
    motion.kind = MotionScene::Kind::Velocity;
    motion.velocity = {m.expression("x"), m.expression("y"), m.expression("z")};
  } else if (type == "displacement") {
    motion.kind = MotionScene::Kind::Displacement;
    motion.direction = unit_vector(m, "direction");
    motion.table = TabulatedCurve::read_csv(m.file("table"), "m");
  } else if (type == "force") {
    motion.kind = MotionScene::Kind::Force;
    motion.direction = unit_vector(m, "direction");
    motion.force = read_force(m);
  }
  return motion;
}

}  // namespace

MotionScene read_motion(const Parameters& p) {
  MotionScene motion = p.has("motion") ? read_translation(p.table("motion")) : MotionScene{};
  if (p.has("rotation")) {
    const RotationScene rotation = *rotation_of(p);
    motion.centre = rotation.centre;
    motion.axis = rotation.axis;
    motion.rotation = rotation.rate;
  }
  if (p.has("rotation_table")) {
    if (!p.has("rotation")) p.fail("rotation_table", "needs [rigid.rotation] for the axis; its rate is then ignored.");
    motion.rotation_table = TabulatedCurve::read_csv(p.file("rotation_table"), "rad/s");
  }
  if (p.has("retreat")) motion.retreat = read_retreat(p.table("retreat"), motion);
  return motion;
}

bool GripScene::rigid(const Space& space) const {
  const auto same_everywhere = [&](const OptionalExpression& component) {
    return component && !component->contains("x") && !component->contains("y") && !component->contains("z");
  };
  for (int d = 0; d < layout_of(space).velocity_components; ++d) {
    const bool across = rotation && std::abs(rotation->axis[d]) < 1e-9;
    if (!across && !same_everywhere(velocity[d])) return false;
  }
  return true;
}

}  // namespace stirsph
