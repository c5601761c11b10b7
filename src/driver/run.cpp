#include "driver/run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <utility>

#include "base/log.hpp"
#include "driver/diagnostics.hpp"
#include "driver/probes.hpp"
#include "driver/simulation.hpp"
#include "io/checkpoint.hpp"
#include "io/files.hpp"
#include "io/history.hpp"
#include "io/snapshot.hpp"
#include "mechanics/simd.hpp"
#include "particles/field_names.hpp"

#ifndef STIRSPH_VERSION
#define STIRSPH_VERSION "unknown"
#endif
#ifndef STIRSPH_COMMIT
#define STIRSPH_COMMIT "unknown"
#endif

namespace stirsph {
namespace {

volatile std::sig_atomic_t stop_signal = 0;
void remember_signal(int number) { stop_signal = number; }

/// Everything a run does besides stepping.
class Run {
 public:
  Run(const Comm& comm, const Scene& scene, const RunOptions& options)
      : comm_(comm),
        options_(options),
        simulation_(comm, scene),
        snapshots_(comm, options.folder, scene.output.fields),
        began_(wall_seconds()) {}

  ExitCode execute();

 private:
  void open_folder();
  void begin();
  void print_header() const;
  void after_step();
  void record_history();
  void write_snapshot();
  void save(const std::string& why);
  void save_failed_state() noexcept;
  void print_progress();
  void print_report(const Diagnostics& d);
  void write_summary(const Diagnostics& d);
  std::int64_t instants_passed(double interval) const;
  bool due(double interval, std::int64_t& passed) const;
  double elapsed() const { return wall_seconds() - began_; }

  Comm comm_;
  RunOptions options_;
  Simulation simulation_;
  SnapshotSeries snapshots_;
  History history_;
  double began_;
  double first_time_ = 0;
  std::int64_t first_step_ = 0;
  std::int64_t history_instants_ = 0, snapshot_instants_ = 0;
  double last_progress_ = 0, last_checkpoint_ = 0, checkpoint_cost_ = 0;
  std::int64_t last_snapshot_step_ = -1, last_checkpoint_step_ = -1;
};

ExitCode Run::execute() {
  open_folder();
  begin();
  print_header();
  try {
    while (!simulation_.finished()) {
      auto& requests = simulation_.requests;
      requests = {};
      // One rank decides what depends on the wall clock; any rank may have got the signal.
      requests.stop = stop_signal != 0;
      if (comm_.is_root()) {
        const double margin = 3 * checkpoint_cost_ + 2;
        requests.stop |= options_.wall_limit > 0 && elapsed() + margin > options_.wall_limit;
        requests.stop |= simulation_.clock().step % 100 == 0 && std::filesystem::exists(options_.folder + "/stop");
        requests.progress = elapsed() - last_progress_ >= simulation_.scene().output.progress_wall;
        const double wall = simulation_.scene().output.checkpoint_wall;
        requests.checkpoint = wall > 0 && elapsed() - last_checkpoint_ >= wall;
      }
      simulation_.step();
      after_step();
      if (requests.stop) {
        save("stop requested");
        if (comm_.is_root()) remove_quietly(options_.folder + "/stop");
        print_report(diagnose(simulation_));
        log::info(fmt::format("stopped at t = {:.6g} s; continue with --restart auto", simulation_.clock().time));
        return ExitCode::Stopped;
      }
    }
  } catch (const Error& error) {
    save_failed_state();
    throw Error(error.code(), fmt::format("step {}, t = {:.6g} s: {}", simulation_.clock().step,
                                          simulation_.clock().time, error.what()));
  }
  if (last_snapshot_step_ != simulation_.clock().step) write_snapshot();
  save("end of the run");
  const Diagnostics d = diagnose(simulation_);
  print_report(d);
  comm_.together([&] { write_summary(d); });
  return ExitCode::Finished;
}

void Run::open_folder() {
  comm_.together([&] {
    if (!comm_.is_root()) return;
    make_folder(options_.folder);
    log::open(0, options_.folder + "/run.log", !options_.restart.empty(), options_.quiet);
    write_text_file(options_.folder + "/input_as_used.toml", simulation_.scene().effective_input);
  });
}

void Run::begin() {
  const Scene& scene = simulation_.scene();
  std::string checkpoint = options_.restart;
  if (!checkpoint.empty() && checkpoint != "auto" && !std::filesystem::exists(checkpoint))
    throw InputError(
        "--restart " + checkpoint +
        ": there is no such file. Allowed: a checkpoint file, or auto for the newest in the output folder");
  if (checkpoint == "auto") checkpoint = find_newest_checkpoint(comm_, options_.folder);
  comm_.together([&] { check_field_names(simulation_); });
  if (checkpoint.empty()) {
    simulation_.start();
    comm_.together(
        [&] { history_ = History::begin(comm_.is_root(), options_.folder + "/history.csv", history_columns(scene)); });
    record_history();
    write_snapshot();
  } else {
    simulation_.resume(checkpoint);
    const Clock& clock = simulation_.clock();
    set_aside_checkpoints_after(comm_, options_.folder, clock.step);
    comm_.together([&] {
      history_ = History::resume(comm_.is_root(), options_.folder + "/history.csv", history_columns(scene), clock.time);
    });
    snapshots_.resume(clock.time, 0.1 * clock.next_dt);
    log::info("continuing from " + checkpoint);
  }
  first_time_ = simulation_.clock().time;
  first_step_ = simulation_.clock().step;
  history_instants_ = instants_passed(scene.output.history_interval);
  snapshot_instants_ = instants_passed(scene.output.snapshot_interval);
}

/// How many multiples of the interval lie behind the present step or nearest to it: a function of the clock alone, so
/// that outputs fall on the same steps with and without a restart.
std::int64_t Run::instants_passed(double interval) const {
  const Clock& clock = simulation_.clock();
  return interval > 0 ? static_cast<std::int64_t>(std::floor((clock.time + 0.5 * clock.dt) / interval)) : 0;
}

bool Run::due(double interval, std::int64_t& passed) const {
  const std::int64_t now = instants_passed(interval);
  return std::exchange(passed, now) < now;
}

void Run::after_step() {
  const OutputScene& output = simulation_.scene().output;
  const std::int64_t step = simulation_.clock().step;
  const bool by_steps = output.history_steps > 0 && step % output.history_steps == 0;
  if (due(output.history_interval, history_instants_) || by_steps) record_history();
  if (due(output.snapshot_interval, snapshot_instants_)) write_snapshot();
  const bool checkpoint_by_steps = output.checkpoint_steps > 0 && step % output.checkpoint_steps == 0;
  if (simulation_.requests.checkpoint || checkpoint_by_steps) save("");
  if (simulation_.requests.progress) print_progress();
}

void Run::record_history() {
  const std::vector<double> row = history_row(simulation_, diagnose(simulation_));
  comm_.together([&] { history_.write(simulation_.clock().time, row); });
}

void Run::write_snapshot() {
  std::vector<DerivedField> derived;
  if (simulation_.mechanics()) {
    const ParticleSet& p = simulation_.particles();
    DerivedField mises{"von_mises", "Pa", "equivalent stress sqrt(3/2 s:s)", {}};
    DerivedField pressure{"pressure", "Pa", "minus the mean stress", {}};
    for (std::size_t i = 0; i < p.owned(); ++i) {
      double mean = 0, sum = 0;
      for (int c = 0; c < 3; ++c) mean += p.component(field::stress, c)[i] / 3;
      for (int c = 0; c < p.layout().stress_components; ++c) {
        const double s = p.component(field::stress, c)[i] - (c < 3 ? mean : 0);
        sum += (c < 3 ? 1.5 : 3.0) * s * s;
      }
      mises.values.push_back(std::sqrt(sum));
      pressure.values.push_back(-mean);
    }
    derived = {std::move(mises), std::move(pressure)};
  }
  snapshots_.write(simulation_.particles(), simulation_.clock().time, simulation_.clock().step, derived);
  last_snapshot_step_ = simulation_.clock().step;
}

void Run::save(const std::string& why) {
  const OutputScene& output = simulation_.scene().output;
  const bool wanted = output.checkpoint_wall > 0 || output.checkpoint_steps > 0 || why == "stop requested";
  if (!wanted || last_checkpoint_step_ == simulation_.clock().step) return;
  const double start = wall_seconds();
  write_checkpoint(comm_, checkpoint_path(options_.folder, simulation_.clock().step), simulation_.particles(),
                   simulation_.named_state());
  keep_newest_checkpoints(comm_, options_.folder, 2);
  checkpoint_cost_ = std::max(checkpoint_cost_, wall_seconds() - start);
  last_checkpoint_ = elapsed();
  last_checkpoint_step_ = simulation_.clock().step;
  if (!why.empty()) log::info(fmt::format("checkpoint at step {} ({})", simulation_.clock().step, why));
}

void Run::save_failed_state() noexcept {
  try {
    write_checkpoint(comm_, options_.folder + "/failed_state.h5", simulation_.particles(), simulation_.named_state());
    log::info("the state was saved in " + options_.folder + "/failed_state.h5 for inspection");
  } catch (const std::exception& failure) {
    log::warning(std::string("the state could not be saved: ") + failure.what());
  }
}

void Run::print_header() const {
  const Scene& scene = simulation_.scene();
  std::string bodies;
  for (const BodyCount& body : simulation_.body_counts())
    bodies +=
        fmt::format("{}{}: {} particles, {:.4g} kg", bodies.empty() ? "" : "; ", body.name, body.particles, body.mass);
  std::int64_t bytes = static_cast<std::int64_t>(simulation_.particles().bytes() + simulation_.neighbourhood().bytes() +
                                                 (simulation_.mechanics() ? simulation_.mechanics()->bytes() : 0));
  bytes = comm_.sum(bytes);
  log::info(version_text());
  log::info(fmt::format("scene: {} ({}), space {}, {} ranks", scene.path, scene.title, keyword_of(scene.space),
                        comm_.size()));
  log::info(fmt::format("bodies: {}", bodies));
  if (scene.mechanics)
    log::info(fmt::format(
        "dt {:.4g} s from {}; wave speed {:.4g} m/s (density scale {:.4g}, elastic scale {:.4g}); {:.0f} B per "
        "particle",
        simulation_.clock().next_dt, scene.time.fixed_step > 0 ? "time.step" : "the Courant number",
        simulation_.mechanics()->wave_speed(), scene.numerics.density_scale, scene.numerics.elastic_scale,
        static_cast<double>(bytes) / static_cast<double>(std::max<std::int64_t>(1, simulation_.particle_count()))));
  log::info(fmt::format("{:>9} {:>11} {:>9} {:>8} {:>8} {:>9} {:>7} {:>10} {:>9} {:>8} {:>8} {:>7} {:>6}", "step",
                        "t [s]", "dt [s]", "wall[s]", "ETA [s]", "part-st/s", "T max", "tool F [N]", "M [N m]", "KE/IE",
                        "inertia", "pen/dx", "imbal"));
}

void Run::print_progress() {
  const Diagnostics d = diagnose(simulation_);
  const double imbalance = simulation_.neighbourhood().imbalance();
  last_progress_ = elapsed();
  const Scene& scene = simulation_.scene();
  const Clock& clock = simulation_.clock();
  const double done = (clock.time - first_time_) / std::max(1e-300, scene.time.end - first_time_);
  const double rate =
      static_cast<double>(clock.step - first_step_) * static_cast<double>(simulation_.particle_count()) / elapsed();
  const int tool = tool_index(scene);
  const Vec3 force = tool >= 0 ? simulation_.rigid_force(tool) : Vec3{};
  const double torque = tool >= 0 ? dot(simulation_.rigid_torque(tool), simulation_.rigids()[tool].pose.axis) : 0.0;
  const double along = tool >= 0 ? -dot(force, scene.rigids[tool].motion.direction) : 0.0;
  const double internal = d.energy.elastic + d.energy.plastic;
  log::info(fmt::format(
      "{:>9} {:>11.5g} {:>9.3g} {:>8.1f} {:>8.0f} {:>9.3g} {:>7.1f} {:>10.4g} {:>9.4g} {:>8.2g} {:>8.2g} {:>7.3f} "
      "{:>6.2f}{}",
      clock.step, clock.time, clock.dt, elapsed(), done > 0 ? elapsed() * (1 / done - 1) : 0.0, rate, d.temperature_max,
      along, torque, internal > 0 ? d.energy.kinetic / internal : 0.0, d.inertia_number,
      simulation_.largest_penetration() / scene.numerics.spacing, imbalance,
      tool >= 0 && simulation_.motions()[tool].at_velocity_limit() ? "  (tool at its velocity limit)" : ""));
}

void Run::print_report(const Diagnostics& d) {
  const Clock& clock = simulation_.clock();
  const EnergyBalance& e = d.energy;
  log::info(fmt::format("t = {:.6g} s after {} steps, {:.1f} s wall", clock.time, clock.step, elapsed()));
  if (simulation_.mechanics()) {
    log::info(
        fmt::format("energy [J]: kinetic {:.4g} (physical {:.3g}), elastic {:.4g}, plastic {:.4g}, viscous {:.4g}, "
                    "density diffusion {:.4g}, friction {:.4g}, contact {:.4g}, external work {:.4g}",
                    e.kinetic, e.kinetic_physical, e.elastic, e.plastic, e.viscous, e.diffusion, e.friction, e.contact,
                    e.external));
    log::info(fmt::format(
        "energy residual {:.3g}; viscous/plastic dissipation {:.3g}; inertia number {:.3g}; leaked particles {}",
        e.residual(), d.viscous_ratio, d.inertia_number, d.leaked));
    log::info(fmt::format("list rebuilds: {}", simulation_.neighbourhood().rebuilds()));
  }
  if (simulation_.scene().heat.mode == HeatScene::Mode::Conduction) {
    const HeatLedger& heat = simulation_.heat_ledger();
    log::info(
        fmt::format("heat [J]: sources {:.4g} = particles {:.4g} + lumped bodies {:.4g} + fixed bodies {:.4g} + "
                    "surroundings {:.4g}",
                    heat.source, heat.particles, heat.rigid, heat.fixed, heat.ambient));
  }
  for (const auto& [phase, seconds] : simulation_.timers().seconds()) {
    const double least = comm_.min(seconds), most = comm_.max(seconds), mean = comm_.sum(seconds) / comm_.size();
    log::info(fmt::format("  {:<12} {:8.2f} s mean, {:.2f} .. {:.2f} over ranks", phase, mean, least, most));
  }
}

void Run::write_summary(const Diagnostics& d) {
  if (!comm_.is_root()) return;
  const Scene& scene = simulation_.scene();
  double tube = 0;
  std::string materials;
  for (const Material& material : scene.materials)
    materials += (materials.empty() ? "\"" : ", \"") + material.name + "\"";
  for (std::size_t k = 0; k < scene.probes.size(); ++k)
    if (scene.probes[k].kind == ProbeScene::Kind::ExtrudedLength) tube = d.probes[k];
  write_text_file(
      options_.folder + "/summary.json",
      fmt::format(
          "{{\"wall_s\": {:.3f}, \"steps\": {}, \"time_s\": {:.9g}, \"particles\": {}, \"ranks\": {}, "
          "\"tube_length_mm\": {:.4g}, \"T_max_K\": {:.6g}, \"lost_particles\": {}, "
          "\"energy_residual\": {:.4g}, \"inertia_number\": {:.4g}, \"spacing_mm\": {:.6g}, \"materials\": [{}]}}\n",
          elapsed(), simulation_.clock().step, simulation_.clock().time, simulation_.particle_count(), comm_.size(),
          1e3 * tube, d.temperature_max, d.leaked, d.energy.residual(), d.inertia_number, 1e3 * scene.numerics.spacing,
          materials));
}

}  // namespace

void install_stop_signals() {
  std::signal(SIGUSR1, remember_signal);
  std::signal(SIGTERM, remember_signal);
}

std::string version_text() {
  return fmt::format("StirSPH {} (commit {}), g++ {}, {} SIMD lanes", STIRSPH_VERSION, STIRSPH_COMMIT, __VERSION__,
                     lanes);
}

ExitCode run_scene(const Comm& comm, const Scene& scene, const RunOptions& options) {
  return Run(comm, scene, options).execute();
}

}  // namespace stirsph
