#include "bench/measure.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <ctime>
#include <filesystem>

#include "base/simd.hpp"
#include "driver/diagnostics.hpp"
#include "driver/simulation.hpp"
#include "io/files.hpp"
#include "io/history.hpp"
#include "io/snapshot.hpp"
#include "particles/field_names.hpp"

namespace stirsph::bench {
namespace {

constexpr int warming_steps = 3;

/// Processor time of this process so far; waiting for a message counts, waiting for a processor does not.
double processor_seconds() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

Phase over_ranks(const Comm& comm, double own) { return {comm.min(own), comm.sum(own) / comm.size(), comm.max(own)}; }

/// Who is within the support of whom, at this moment.
struct Reach {
  double neighbours = 0;  ///< mean per particle, self not counted
  double visited = 0;     ///< mean per register: candidates that the second sweep works through
};

Reach count_reach(const Simulation& simulation) {
  const ParticleSet& particles = simulation.particles();
  const PairList& pairs = simulation.neighbourhood().pairs();
  const double support = simulation.mechanics()->support(particles);
  double neighbours = 0, visited = 0, registers = 0;
  for (std::size_t first = 0; first < particles.owned(); first += lanes) {
    registers += 1;
    visited += cluster_size;  // the register's own cluster; of the others those behind it (ActivePairs)
    const std::size_t end = (first / cluster_size + 1) * cluster_size;
    for (const std::int32_t j : pairs.candidates(first / cluster_size)) {
      const Vec3 other = particles.vector_at(field::position, static_cast<std::size_t>(j));
      int near = 0;
      for (std::size_t i = first; i < std::min(first + lanes, particles.owned()); ++i)
        near += norm(particles.vector_at(field::position, i) - other) < support;
      neighbours += near;
      visited += near > 0 && static_cast<std::size_t>(j) >= end;
    }
  }
  const Comm& comm = simulation.comm();
  return {comm.sum(neighbours) / static_cast<double>(simulation.particle_count()) - 1,
          comm.sum(visited) / comm.sum(registers)};
}

/// A folder of the system's temporary place for as long as this lives. Collective.
class ScratchFolder {
 public:
  explicit ScratchFolder(const Comm& comm) : comm_(comm) {
    const auto path = std::filesystem::temp_directory_path() / fmt::format("stirsph_bench_{}", getpid());
    path_ = comm.broadcast(path.string());
    comm.together([&] {
      if (comm.is_root()) make_folder(path_);
    });
  }
  ~ScratchFolder() {
    comm_.barrier();
    std::error_code ignored;
    if (comm_.is_root()) std::filesystem::remove_all(path_, ignored);
  }
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;
  const std::string& path() const { return path_; }

 private:
  Comm comm_;
  std::string path_;
};

/// Seconds of output on this rank that fall on one step at the scene's intervals.
double output_per_step(const Simulation& simulation) {
  const Comm& comm = simulation.comm();
  const OutputScene& output = simulation.scene().output;
  if (output.history_interval <= 0 && output.snapshot_interval <= 0) return 0;
  const ScratchFolder folder(comm);
  double seconds = 0;
  const auto add = [&](double interval, auto&& write) {
    if (interval <= 0) return;
    comm.barrier();
    const double start = wall_seconds();
    write();
    seconds += (wall_seconds() - start) * simulation.clock().dt / interval;
  };
  History history;
  comm.together([&] {
    history = History::begin(comm.is_root(), folder.path() + "/history.csv", history_columns(simulation.scene()));
  });
  SnapshotSeries snapshots(comm, folder.path(), output.fields);
  add(output.history_interval, [&] {
    const std::vector<double> row = history_row(simulation, diagnose(simulation));
    comm.together([&] { history.write(simulation.clock().time, row); });
  });
  add(output.snapshot_interval,
      [&] { snapshots.write(simulation.particles(), simulation.clock().time, simulation.clock().step); });
  return seconds;
}

double seconds_of_a_rebuild(Simulation& simulation) {
  const Comm& comm = simulation.comm();
  comm.barrier();
  const double start = wall_seconds();
  simulation.renew_neighbours_now();
  return comm.sum(wall_seconds() - start) / comm.size();
}

Window time_window(Simulation& simulation, int steps) {
  const Comm& comm = simulation.comm();
  const PhaseTimers before = simulation.timers();
  const long rebuilds = simulation.neighbourhood().rebuilds();
  comm.barrier();
  const double start = wall_seconds(), served = processor_seconds();
  for (int k = 0; k < steps; ++k) simulation.step();
  comm.barrier();
  const double stepping = wall_seconds() - start;
  const double share = (processor_seconds() - served) / stepping;
  const double output = steps * output_per_step(simulation);

  Window window;
  window.seconds = comm.max(stepping + output);
  window.rebuilds = simulation.neighbourhood().rebuilds() - rebuilds;
  window.cpu_share = comm.min(share);
  double timed = 0;
  for (const auto& [phase, total] : simulation.timers().seconds()) {
    const auto found = before.seconds().find(phase);
    const double own = total - (found == before.seconds().end() ? 0.0 : found->second);
    window.phases[phase] = over_ranks(comm, own);
    timed += own;
  }
  window.rebuild_seconds = window.rebuilds > 0 ? window.mean("neighbours") / static_cast<double>(window.rebuilds)
                                               : seconds_of_a_rebuild(simulation);
  window.phases["output"] = over_ranks(comm, output);
  window.phases["other"] = over_ranks(comm, stepping - timed);
  return window;
}

void describe(const Simulation& simulation, Measurement& result) {
  const Comm& comm = simulation.comm();
  const double particles = static_cast<double>(simulation.particle_count());
  const auto per_particle = [&](std::size_t own) { return comm.sum(static_cast<double>(own)) / particles; };
  result.particles = simulation.particle_count();
  result.ranks = comm.size();
  result.spacing = simulation.scene().numerics.spacing;
  result.dt = simulation.clock().dt;
  const Reach reach = count_reach(simulation);
  result.neighbours = reach.neighbours;
  result.visited = reach.visited;
  result.candidates = cluster_size * per_particle(simulation.neighbourhood().pairs().size());
  result.yielding = per_particle(simulation.mechanics()->counters().yielding);
  if (const Contact* contact = simulation.contact()) {
    std::size_t looks = 0;
    const double start = wall_seconds();
    const auto candidates = contact->search(simulation.particles(), simulation.rigids());
    result.contact_search = comm.sum(wall_seconds() - start) / particles;
    for (const auto& near : candidates) looks += near.size();
    result.contact_looks = per_particle(looks);
    result.contact_searches =
        static_cast<double>(contact->searches()) / static_cast<double>(simulation.clock().step + 1);  // and the start
  }
  result.memory = {per_particle(simulation.particles().bytes()), per_particle(simulation.neighbourhood().bytes()),
                   per_particle(simulation.mechanics()->bytes())};
}

}  // namespace

double Window::mean(const std::string& phase) const {
  const auto found = phases.find(phase);
  return found == phases.end() ? 0.0 : found->second.mean;
}

const Window& Measurement::median() const {
  std::vector<const Window*> sorted;
  for (const Window& window : windows) sorted.push_back(&window);
  std::ranges::sort(sorted, {}, [](const Window* window) { return window->seconds; });
  return *sorted[(sorted.size() - 1) / 2];
}

double Measurement::rate(const Window& window) const {
  return static_cast<double>(particles) * steps / window.seconds / ranks;
}

double Measurement::rebuild_cost_steps() const {
  const Window& window = median();
  return window.rebuild_seconds / ((window.seconds - window.mean("neighbours")) / steps);
}

double Measurement::steps_per_list() const {
  long rebuilds = 0;
  for (const Window& window : windows) rebuilds += window.rebuilds;
  const double made = static_cast<double>(steps) * static_cast<double>(windows.size());
  return rebuilds == 0 ? made : made / static_cast<double>(rebuilds);
}

double Measurement::step_overhead_us() const {
  const Window& window = median();
  return 1e6 * (window.seconds - window.mean("stress") - window.mean("forces") - window.mean("neighbours")) / steps;
}

double Measurement::service_share() const {
  const Window& window = median();
  double rest = window.seconds;
  for (const char* phase : {"stress", "forces", "neighbours", "halo"}) rest -= window.mean(phase);
  return rest / window.seconds;
}

Measurement measure(const Comm& comm, const Scene& scene, int steps, int repeats) {
  Measurement result;
  result.steps = steps;
  for (int k = 0; k < repeats; ++k) {
    Simulation simulation(comm, scene);
    simulation.start();
    for (int warm = 0; warm < warming_steps; ++warm) simulation.step();
    result.windows.push_back(time_window(simulation, steps));
    if (k == 0) describe(simulation, result);
  }
  return result;
}

}  // namespace stirsph::bench
