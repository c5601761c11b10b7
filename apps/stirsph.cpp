/// stirsph: runs, checks or documents a scene.
#include <CLI/CLI.hpp>
#include <iostream>
#include <string>

#include "base/comm.hpp"
#include "base/log.hpp"
#include "driver/partition_check.hpp"
#include "driver/run.hpp"
#include "driver/scene_check.hpp"
#include "io/files.hpp"
#include "scene/scene.hpp"
#include "thermal/petsc_session.hpp"

namespace {

using namespace stirsph;

/// "HH:MM:SS", "MM:SS" or seconds -> seconds.
double wall_limit_from(const std::string& text) {
  double seconds = 0;
  std::size_t at = 0;
  while (at <= text.size()) {
    const std::size_t colon = std::min(text.find(':', at), text.size());
    const std::string part = text.substr(at, colon - at);
    std::size_t used = 0;
    double value = -1;
    try {
      value = std::stod(part, &used);
    } catch (const std::exception&) {
    }
    if (used != part.size() || value < 0)
      throw InputError("--wall-limit " + text + ": expected HH:MM:SS, MM:SS or seconds, for example 01:30:00");
    seconds = 60 * seconds + value;
    at = colon + 1;
  }
  return seconds;
}

struct Arguments {
  std::string command = "run", scene, wall_limit, petsc;
  std::vector<std::string> overrides;
  RunOptions run;
  std::vector<int> parts;
  std::string partition_file;
};

ExitCode execute(const Comm& comm, Arguments& arguments) {
  if (arguments.command == "manual") {
    if (comm.is_root()) std::cout << parameter_manual();
    return ExitCode::Finished;
  }
  const Scene scene = read_scene(arguments.scene, arguments.overrides);
  if (arguments.command == "check" && !arguments.parts.empty()) {
    report_partitions(comm, scene, arguments.parts, arguments.partition_file);
    return ExitCode::Finished;
  }
  if (arguments.command == "check") {
    const std::string report = check_scene(comm, scene);
    if (comm.is_root()) std::cout << report;
    return ExitCode::Finished;
  }
  if (!arguments.wall_limit.empty()) arguments.run.wall_limit = wall_limit_from(arguments.wall_limit);
  install_stop_signals();
  return run_scene(comm, scene, arguments.run);
}

}  // namespace

int main(int argc, char** argv) {
  skip_display_probes();
  choose_mpi_io();
  MPI_Init(&argc, &argv);
  ExitCode code = ExitCode::Internal;
  {
    const Comm comm;
    Arguments arguments;
    CLI::App app("StirSPH: friction stir extrusion of tubes with smoothed particle hydrodynamics");
    app.set_version_flag("--version", version_text());
    app.require_subcommand(0, 1);
    app.add_option("scene", arguments.scene, "scene file (TOML)");
    app.add_option("-P,--parameter", arguments.overrides, "override, section.key=value; may be repeated");
    app.add_option("-o,--output", arguments.run.folder, "folder for results")->capture_default_str();
    app.add_option("--restart", arguments.run.restart,
                   "auto (newest checkpoint of the output folder) or a checkpoint file");
    app.add_option("-t,--wall-limit", arguments.wall_limit, "save and leave before this wall time, HH:MM:SS");
    app.add_option("--petsc", arguments.petsc, "PETSc options, for example \"-heat_pc_type bjacobi\"");
    app.add_flag("-q,--quiet", arguments.run.quiet, "nothing on the console");
    auto* check = app.add_subcommand("check", "say what a scene would run, without running it");
    check->add_option("scene", arguments.scene, "scene file (TOML)")->required();
    check->add_option("-P,--parameter", arguments.overrides, "override, section.key=value");
    auto* partition = check
                          ->add_option("--partition", arguments.parts,
                                       "instead: how METIS would cut the particles, for these numbers of ranks, "
                                       "comma-separated")
                          ->delimiter(',')
                          ->check(CLI::Range(1, most_parts));
    check->add_option("--partition-file", arguments.partition_file, "and every part's share in this file (CSV)")
        ->needs(partition);
    app.add_subcommand("manual", "print the parameter manual (Markdown)");
    app.footer(
        "Exit codes: 0 finished, 1 internal error, 2 wrong input, 3 blow-up, 4 linear solver failed, 5 file could "
        "not be written or read, 10 stopped and restartable.");
    bool parsed = false;
    try {
      app.parse(argc, argv);
      parsed = true;
    } catch (const CLI::ParseError& error) {
      const int status = comm.is_root() ? app.exit(error) : error.get_exit_code();
      code = status == 0 ? ExitCode::Finished : ExitCode::Input;
    }
    if (parsed) {
      if (app.got_subcommand("check")) arguments.command = "check";
      if (app.got_subcommand("manual")) arguments.command = "manual";
      try {
        if (arguments.scene.empty() && arguments.command == "run")
          throw InputError("no scene given. Usage: stirsph SCENE.toml [--output FOLDER]; see stirsph --help.");
        const PetscSession petsc(arguments.petsc);
        code = execute(comm, arguments);
      } catch (const Error& error) {
        // Errors of the input are the same on all ranks and errors of the run were agreed on: one message is enough.
        if (comm.is_root()) log::error(error.what());
        code = error.code();
        // A broken promise inside the code may have been noticed by this rank alone; the others would wait for ever.
        if (code == ExitCode::Internal) MPI_Abort(comm.handle(), static_cast<int>(code));
      } catch (const std::exception& error) {
        // Not agreed on: the other ranks may be waiting for this one.
        std::cerr << "stirsph: rank " << comm.rank() << ": internal error: " << error.what() << std::endl;
        MPI_Abort(comm.handle(), static_cast<int>(ExitCode::Internal));
      }
    }
  }
  MPI_Finalize();
  return static_cast<int>(code);
}
