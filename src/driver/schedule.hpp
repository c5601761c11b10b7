/// When an output is due: functions of the clock alone, so that outputs fall on the same steps with and without a
/// restart, and never change a step.
#pragma once

#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "driver/simulation.hpp"

namespace stirsph {

class Schedule {
 public:
  /// Multiples of `interval` [s] (0: none) and further `times` [s].
  explicit Schedule(double interval, std::vector<double> times = {}) : interval_(interval), times_(std::move(times)) {}

  /// Forgets what lies behind.
  void begin(const Clock& clock) { passed_ = instants_passed(clock); }
  /// Whether instants have come since the last call: the step just made is the one nearest to them.
  bool due(const Clock& clock) {
    const std::int64_t now = instants_passed(clock);
    return std::exchange(passed_, now) < now;
  }

 private:
  std::int64_t instants_passed(const Clock& clock) const {
    const double reached = clock.time + 0.5 * clock.dt;
    std::int64_t count = interval_ > 0 ? static_cast<std::int64_t>(std::floor(reached / interval_)) : 0;
    for (const double time : times_) count += time <= reached;
    return count;
  }

  double interval_;
  std::vector<double> times_;
  std::int64_t passed_ = 0;
};

}  // namespace stirsph
