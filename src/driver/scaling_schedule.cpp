#include "driver/scaling_schedule.hpp"

#include <algorithm>

namespace stirsph {
namespace {
constexpr double factor = 2;
constexpr double held = 0.01, lost = 0.03;  // error of a controlled force
// Every lowering makes the next raise wait twice as long, so that a process at the edge does not go to and fro.
constexpr double longest_hold = 1000 * InertiaGuards::memory;
}  // namespace

ScalingSchedule::ScalingSchedule(const Scene& scene)
    : reference_(scene.numerics.density_scale),
      most_(scene.scale_before_flow),
      tolerance_(scene.inertia_tolerance),
      scale_(reference_),
      largest_so_far_(reference_) {}

double ScalingSchedule::lowered(double scale) {
  hold_ = std::min(2 * hold_, longest_hold);
  return std::max(scale, reference_);
}

double ScalingSchedule::next(const InertiaGuards& guards, double force_error) {
  quiet_ += 1;
  double wanted = scale_;
  if (scale_ > reference_ && guards.flows())
    wanted = lowered(reference_);
  else if (scale_ > reference_ && (guards.load() > tolerance_ || force_error > lost))
    wanted = lowered(scale_ / factor);
  else if (quiet_ >= hold_ && force_error <= held && guards.flow_share() < 0.5 * InertiaGuards::onset &&
           factor * guards.load() <= tolerance_)
    wanted = std::min(factor * scale_, most_);
  if (wanted == scale_) return scale_;
  quiet_ = 0;
  changes_ += 1;
  scale_ = wanted;
  largest_so_far_ = std::max(largest_so_far_, scale_);
  return scale_;
}

void ScalingSchedule::restore(const std::vector<double>& state) {
  auto next = state.begin();
  for (double* value : {&scale_, &quiet_, &hold_, &changes_, &largest_so_far_}) *value = *next++;
}

}  // namespace stirsph
