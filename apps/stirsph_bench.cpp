/// stirsph_bench: speed and memory of the mechanical step on fixed scenes, and what the machine could do. Figures are
/// reported, never asserted.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <iostream>
#include <map>

#include "base/comm.hpp"
#include "base/log.hpp"
#include "bench/report.hpp"
#include "bench/scenes.hpp"
#include "driver/partition_check.hpp"
#include "io/files.hpp"
#include "scene/populate.hpp"
#include "thermal/petsc_session.hpp"

namespace {

using namespace stirsph;

constexpr const char* machine_scene = "machine";

const std::map<std::string, GradientCorrection> corrections{
    {"none", GradientCorrection::None}, {"velocity", GradientCorrection::Velocity}, {"full", GradientCorrection::Full}};

struct Arguments {
  bench::Options options;
  int steps = 100;
  bool dry_run = false;
  std::string json;
  std::vector<int> parts;
  std::string partition_file;
};

void add_options(CLI::App& app, Arguments& arguments) {
  std::vector<std::string> scenes = bench::scene_names();
  scenes.push_back(machine_scene);
  app.add_option("scene", arguments.options.scene, "what to run; machine: peak rates of this core, no particles")
      ->check(CLI::IsMember(scenes))
      ->default_val("block");
  app.add_option("--particles", arguments.options.particles, "about this many particles (default: the scene's own)")
      ->check(CLI::Range(8, 100000000));
  app.add_option("--steps", arguments.steps, "steps to time")->check(CLI::PositiveNumber)->capture_default_str();
  app.add_option("--repeat", arguments.options.repeats, "times to start and time the scene; the median is reported")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_option("--gradient-correction", arguments.options.gradient_correction,
                 "of the velocity gradient, or of the momentum too (default: none; velocity in the extrusion)")
      ->check(CLI::IsMember(corrections));
  app.add_option("--json", arguments.json, "file for one JSON record");
  auto* partition = app.add_option("--partition", arguments.parts,
                                   "instead: how METIS would cut the scene, as stirsph check --partition does")
                        ->delimiter(',')
                        ->check(CLI::Range(1, most_parts));
  app.add_option("--partition-file", arguments.partition_file, "and every part's share in this file (CSV)")
      ->needs(partition);
  app.add_flag("--dry-run", arguments.dry_run, "only count the particles");
}

void put(const Comm& comm, const std::string& text, const std::string& json_file, const std::string& json) {
  if (comm.is_root()) std::cout << text << std::flush;
  comm.together([&] {
    if (comm.is_root() && !json_file.empty()) write_text_file(json_file, json);
  });
}

void run_bench(const Comm& comm, Arguments& arguments) {
  bench::Options& options = arguments.options;
  if (options.scene == machine_scene) {
    const bench::MachineRates rates = bench::measure_machine(comm);
    put(comm, bench::text_report(rates, comm.size()), arguments.json, bench::json_report(rates, comm.size()));
    return;
  }
  bench::SceneChoice choice{options.scene, options.particles, std::nullopt};
  if (!options.gradient_correction.empty()) choice.gradient_correction = corrections.at(options.gradient_correction);
  const Scene scene = bench::bench_scene(choice);
  if (!arguments.parts.empty()) {
    report_partitions(comm, scene, arguments.parts, arguments.partition_file);
    return;
  }
  for (const auto& [keyword, correction] : corrections)
    if (correction == scene.numerics.gradient_correction) options.gradient_correction = keyword;
  if (arguments.dry_run) {
    std::int64_t particles = 0;
    for (const BodyCount& body : count_particles(scene)) particles += body.particles;
    put(comm, fmt::format("particles={} spacing_mm={:.6g}\n", particles, 1e3 * scene.numerics.spacing), arguments.json,
        bench::json_report(options, particles, scene.numerics.spacing, comm.size()));
    return;
  }
  const bench::Measurement measurement = bench::measure(comm, scene, arguments.steps, options.repeats);
  put(comm, bench::text_report(options, measurement), arguments.json, bench::json_report(options, measurement));
}

}  // namespace

int main(int argc, char** argv) {
  stirsph::skip_display_probes();
  stirsph::choose_mpi_io();
  MPI_Init(&argc, &argv);
  int status = 0;
  {
    const stirsph::Comm comm;
    Arguments arguments;
    CLI::App app("Speed and memory of the mechanical step");
    add_options(app, arguments);
    try {
      app.parse(argc, argv);
      const stirsph::PetscSession petsc;
      run_bench(comm, arguments);
    } catch (const CLI::ParseError& error) {
      status = comm.is_root() ? app.exit(error) : error.get_exit_code();
    } catch (const std::exception& error) {
      std::cerr << "stirsph_bench: " << error.what() << std::endl;
      status = static_cast<int>(stirsph::ExitCode::Internal);
      MPI_Abort(comm.handle(), status);
    }
  }
  MPI_Finalize();
  return status;
}
