/// Mass scaling that follows the process: large while a tool slides on metal that does not flow, where any scaling
/// gives the same answer, and down to the scene's own as soon as metal flows.
#pragma once

#include <vector>

#include "driver/inertia_guards.hpp"
#include "scene/scene.hpp"

namespace stirsph {

class ScalingSchedule {
 public:
  explicit ScalingSchedule(const Scene& scene);

  /// The scaling from now on, after a look of the guards; the same on all ranks. At onset of flow it is at once the
  /// scene's density_scale; otherwise it is halved when a guard is above the tolerance or a force is not held, and
  /// doubled when metal is at rest, no guard would come near the tolerance and forces are held, at most once in so many
  /// looks. `force_error`: the largest of the force controllers, over their targets; they get slower and their impacts
  /// harder as mass grows, so that contact is made and the force settles with the scene's own scaling.
  double next(const InertiaGuards& guards, double force_error);

  double scale() const { return scale_; }
  double largest_so_far() const { return largest_so_far_; }
  int changes() const { return static_cast<int>(changes_); }

  std::vector<double> state() const { return {scale_, quiet_, hold_, changes_, largest_so_far_}; }
  void restore(const std::vector<double>& state);
  static constexpr std::size_t state_size = 5;

 private:
  double lowered(double scale);

  double reference_, most_, tolerance_;
  double scale_, largest_so_far_;
  double quiet_ = 0;                     ///< looks since the last change
  double hold_ = InertiaGuards::memory;  ///< looks that must pass before the scaling is raised
  double changes_ = 0;
};

}  // namespace stirsph
