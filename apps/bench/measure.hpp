/// Times the step loop of a scene, again and again from the same start.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "base/comm.hpp"
#include "scene/scene.hpp"

namespace stirsph::bench {

/// Seconds over the ranks.
struct Phase {
  double least = 0, mean = 0, most = 0;
};

/// One timed window. Phases are those of Simulation::timers(), and two more: "output", the share of history rows and
/// snapshots that falls on the window at the scene's intervals (each is written once after the window and timed), and
/// "other", what no timer saw. All phases together are `seconds` on each rank.
struct Window {
  double seconds = 0;          ///< wall time with output, of the slowest rank
  long rebuilds = 0;           ///< of the pair list
  double rebuild_seconds = 0;  ///< of one rebuild, mean over ranks; of one made after the window if it saw none
  double cpu_share = 0;        ///< of the wall time that the least served rank had a processor; 1 on an idle machine
  std::map<std::string, Phase> phases;

  /// Mean seconds of a phase; 0 when it did not occur.
  double mean(const std::string& phase) const;
};

/// Bytes over all ranks, per particle.
struct Memory {
  double particles = 0, list = 0, mechanics = 0;
  double total() const { return particles + list + mechanics; }
};

struct Measurement {
  std::int64_t particles = 0;
  int ranks = 1, steps = 0;
  double spacing = 0, dt = 0;   ///< m; s, of the last step
  double neighbours = 0;        ///< mean number within the support, self not counted
  double candidates = 0;        ///< mean length of a cluster's list
  double visited = 0;           ///< mean per register: candidates that the second sweep works through
  double yielding = 0;          ///< share of the particles
  double contact_looks = 0;     ///< contact candidates per particle
  double contact_search = 0;    ///< s of one search for them on all ranks, per particle
  double contact_searches = 0;  ///< searches per step since the start
  Memory memory;
  std::vector<Window> windows;  ///< in the order measured

  /// The window of median wall time (the faster of the middle two).
  const Window& median() const;
  /// Particle-steps per second and rank.
  double rate(const Window& window) const;
  /// Seconds of one list rebuild over seconds of one step without.
  double rebuild_cost_steps() const;
  /// Steps over rebuilds, all windows; when there was no rebuild, the number of steps, a lower bound.
  double steps_per_list() const;
  /// Microseconds per step of the median window beyond the sweeps (phases "stress" and "forces", which hold the
  /// material update and the packing too), list rebuilds not counted.
  double step_overhead_us() const;
  /// Contact, integration, ledgers, output and everything else but sweeps, lists and halo, over the whole step.
  double service_share() const;
};

/// Starts the scene `repeats` times, makes three steps to warm caches and lists and times the next `steps`. Collective.
Measurement measure(const Comm& comm, const Scene& scene, int steps, int repeats);

}  // namespace stirsph::bench
