#include "scene/rigid_motion.hpp"

#include <algorithm>
#include <cmath>
#include <span>

#include <fmt/format.h>

namespace stirsph {

RigidMotion::RigidMotion(const MotionScene& scene, const BilletStiffness& billet) : scene_(scene) {
  if (scene_.kind == MotionScene::Kind::Force) control_.emplace(scene_.force, billet);
}

RigidPose RigidMotion::initial_pose() const {
  RigidPose pose;
  pose.centre = scene_.centre;
  pose.axis = scene_.axis;
  pose.angular_velocity = rate(0);
  for (int d = 0; d < 3; ++d)
    if (scene_.velocity[d]) pose.velocity[d] = (*scene_.velocity[d])({0.0});
  if (scene_.table) pose.translation = scene_.direction * scene_.table->value(0);
  return pose;
}

double RigidMotion::rate(double t) const {
  if (scene_.rotation_table) return scene_.rotation_table->value(t);
  return scene_.rotation ? (*scene_.rotation)({t}) : 0.0;
}

void RigidMotion::renew_gains(const BilletStiffness& billet) {
  if (control_) control_->renew_gains(billet);
}

bool RigidMotion::retreat_has_begun(double t) const {
  if (!scene_.retreat) return false;
  const RetreatScene& retreat = *scene_.retreat;
  if (!retreat.at && control_) return control_->time_since_end() >= retreat.dwell * (1 - 1e-12);
  const double begin = retreat.at ? *retreat.at : scene_.table->last_time() + retreat.dwell;
  return t >= begin * (1 - 1e-12);  // a step that should end there may fall short by rounding
}

Vec3 RigidMotion::retreat_velocity(double dt) {
  const RetreatScene& retreat = *scene_.retreat;
  const double way = std::min(retreat.speed * dt, retreat.distance - retreated_);
  retreated_ += way;
  return retreat.direction * (way / dt);
}

void RigidMotion::advance(RigidPose& pose, double t, double dt, const Vec3& force) {
  const double middle = t + 0.5 * dt;
  const bool retreats = retreat_has_begun(t);
  pose.angular_velocity = retreats && scene_.retreat->stop_rotation ? 0.0 : rate(middle);
  pose.angle += pose.angular_velocity * dt;
  if (retreats) {
    pose.velocity = retreat_velocity(dt);
  } else {
    switch (scene_.kind) {
      case MotionScene::Kind::Fixed:
        pose.velocity = {};
        break;
      case MotionScene::Kind::Velocity:
        for (int d = 0; d < 3; ++d) pose.velocity[d] = scene_.velocity[d] ? (*scene_.velocity[d])({middle}) : 0.0;
        break;
      case MotionScene::Kind::Displacement:
        // Follows the table exactly: the position at t + dt is the table's, whatever the steps before.
        pose.velocity = (scene_.direction * scene_.table->value(t + dt) - pose.translation) / dt;
        break;
      case MotionScene::Kind::Force:
        pose.velocity = scene_.direction *
                        control_->speed(dt, -dot(force, scene_.direction), dot(pose.translation, scene_.direction));
        break;
    }
  }
  pose.translation += pose.velocity * dt;
}

std::string RigidMotion::describe() const {
  std::string text;
  if (control_) {
    const ForceScene& f = scene_.force;
    text = fmt::format(
        "approach at {:.4g} mm/s (impact force up to {:.4g} N), {:.4g} N for {:.4g} s, {:.4g} N/s up to "
        "{:.4g} N; velocity limit {:.4g} mm/s",
        1e3 * control_->approach_speed(), control_->impact_force(), f.preload, f.dwell, f.ramp_rate, f.target,
        1e3 * f.velocity_limit);
    if (std::isfinite(f.stroke_limit)) text += fmt::format(", stroke limit {:.4g} mm", 1e3 * f.stroke_limit);
  } else if (scene_.table) {
    text = fmt::format("displacement table from {:.4g} s to {:.4g} s, held before and after",
                       scene_.table->first_time(), scene_.table->last_time());
  }
  if (scene_.retreat) {
    const RetreatScene& r = *scene_.retreat;
    text += fmt::format("{}retreat of {:.4g} mm at {:.4g} mm/s {}", text.empty() ? "" : "; ", 1e3 * r.distance,
                        1e3 * r.speed,
                        r.at ? fmt::format("from {:.4g} s", *r.at) : fmt::format("after {:.4g} s of dwell", r.dwell));
  }
  return text;
}

std::string RigidMotion::remark() const {
  if (retreating()) return "retreating";
  if (!control_) return "";
  if (control_->phase() == ForceControl::Phase::Search) return "searching contact";
  if (control_->phase() == ForceControl::Phase::StrokeEnd) return "at its stroke limit";
  return control_->at_velocity_limit() ? "at its velocity limit" : "";
}

std::vector<double> RigidMotion::state() const {
  std::vector<double> result{retreated_};
  if (control_)
    for (const double value : control_->state()) result.push_back(value);
  return result;
}

void RigidMotion::restore(const std::vector<double>& state) {
  retreated_ = state.at(0);
  if (control_) control_->restore(std::span(state).subspan(1).first<ForceControl::state_size>());
}

}  // namespace stirsph
