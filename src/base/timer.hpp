/// Wall-clock timers for the phases of a step.
#pragma once

#include <chrono>
#include <map>
#include <string>

namespace stirsph {

inline double wall_seconds() {
  using clock = std::chrono::steady_clock;
  return std::chrono::duration<double>(clock::now().time_since_epoch()).count();
}

/// Seconds per named phase on this rank.
class PhaseTimers {
 public:
  double& operator[](const char* phase) { return seconds_[phase]; }
  const std::map<std::string, double>& seconds() const { return seconds_; }
  void clear() { seconds_.clear(); }

 private:
  std::map<std::string, double> seconds_;
};

/// Adds its lifetime to a phase; an early return or an exception cannot miss the end.
class ScopedTimer {
 public:
  ScopedTimer(PhaseTimers& timers, const char* phase) : total_(timers[phase]), start_(wall_seconds()) {}
  ~ScopedTimer() { total_ += wall_seconds() - start_; }
  ScopedTimer(const ScopedTimer&) = delete;
  ScopedTimer& operator=(const ScopedTimer&) = delete;

 private:
  double& total_;
  double start_;
};

}  // namespace stirsph
