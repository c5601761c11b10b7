#include "scene/force_control.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace stirsph {
namespace {

// Shares of the preload: a force that counts as contact, one so small that contact is lost (well below, or noise would
// switch back and forth), and the largest impact that the default approach speed may cause.
constexpr double felt = 0.02, lost = 0.005, allowed_impact = 0.2;

}  // namespace

ForceControl::ForceControl(const ForceScene& scene, const BilletStiffness& billet) : scene_(scene) {
  renew_gains(billet);
}

void ForceControl::renew_gains(const BilletStiffness& billet) {
  const double stiffness = scene_.stiffness > 0 ? scene_.stiffness : billet.stiffness;
  const double frequency = scene_.bandwidth * billet.angular_frequency;
  integral_gain_ = frequency * frequency / stiffness;
  proportional_ = 2 * frequency / stiffness;
  filter_rate_ = 4 * frequency;
  impedance_ = billet.impedance;
  approach_speed_ = scene_.approach_speed;
  if (approach_speed_ <= 0) {
    approach_speed_ = scene_.velocity_limit;
    if (impedance_ > 0) approach_speed_ = std::min(approach_speed_, allowed_impact * scene_.preload / impedance_);
  }
}

double ForceControl::programme() const {
  return std::min(scene_.preload + scene_.ramp_rate * std::max(0.0, clock_ - scene_.dwell), scene_.target);
}

double ForceControl::programme_end() const {
  return std::max(scene_.approach_time, scene_.dwell + (scene_.target - scene_.preload) / scene_.ramp_rate);
}

double ForceControl::target_force() const { return in_contact_ ? applied_ * programme() : 0.0; }

double ForceControl::error() const {
  if (stroke_ended_) return 0;
  if (!in_contact_) return std::numeric_limits<double>::infinity();
  return std::abs(filtered_ - target_force()) / target_force();
}

ForceControl::Phase ForceControl::phase() const {
  if (stroke_ended_) return Phase::StrokeEnd;
  if (!in_contact_) return Phase::Search;
  if (clock_ >= programme_end()) return Phase::Hold;
  return clock_ > scene_.dwell ? Phase::Ramp : Phase::Preload;
}

bool ForceControl::finds_contact(double force) {
  if (!in_contact_ && force > felt * scene_.preload) {
    in_contact_ = true;
    filtered_ = force;
    integral_ = 0;
    applied_ = std::min(1.0, force / programme());  // no step: the force is raised from what is felt
  } else if (in_contact_ && filtered_ < lost * scene_.preload) {
    in_contact_ = false;
  }
  return in_contact_;
}

double ForceControl::speed(double dt, double force, double travel) {
  if (stroke_ended_ || phase() == Phase::Hold) since_end_ += dt;
  at_limit_ = false;
  if (stroke_ended_) return 0;
  filtered_ += (force - filtered_) * (1 - std::exp(-filter_rate_ * dt));
  double result = approach_speed_;
  if (finds_contact(force)) {
    clock_ += dt;
    applied_ = std::min(1.0, applied_ + dt / scene_.approach_time);
    const double error = target_force() - filtered_;
    const double step = integral_gain_ * error * dt, wanted = integral_ + step + proportional_ * error;
    result = std::clamp(wanted, -scene_.withdrawal_limit, scene_.velocity_limit);
    at_limit_ = result != wanted;
    // Anti-windup: while a limit holds, the integral does not grow, and never beyond what the limits allow.
    if (!at_limit_) integral_ += step;
    integral_ = std::clamp(integral_, -scene_.withdrawal_limit, scene_.velocity_limit);
  }
  if (at_limit_) time_at_limit_ += dt;
  const double left = scene_.stroke_limit - travel;
  if (result * dt >= left) {
    stroke_ended_ = true;
    result = std::max(left, 0.0) / dt;
  }
  return result;
}

std::array<double, ForceControl::state_size> ForceControl::state() const {
  return {integral_,
          filtered_,
          clock_,
          applied_,
          since_end_,
          time_at_limit_,
          in_contact_ ? 1.0 : 0.0,
          stroke_ended_ ? 1.0 : 0.0,
          at_limit_ ? 1.0 : 0.0};
}

void ForceControl::restore(std::span<const double, state_size> state) {
  auto next = state.begin();
  for (double* value : {&integral_, &filtered_, &clock_, &applied_, &since_end_, &time_at_limit_}) *value = *next++;
  for (bool* flag : {&in_contact_, &stroke_ended_, &at_limit_}) *flag = *next++ != 0;
}

}  // namespace stirsph
