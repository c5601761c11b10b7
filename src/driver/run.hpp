/// A whole run: steps, outputs, checkpoints, and the ways it can end.
#pragma once

#include <string>

#include "base/comm.hpp"
#include "base/error.hpp"
#include "scene/scene.hpp"

namespace stirsph {

struct RunOptions {
  std::string folder = "run";  ///< where results go
  std::string restart;         ///< "", "auto" (newest checkpoint of the folder, or a fresh start) or a checkpoint file
  double wall_limit = 0;       ///< s; 0 = none
  bool quiet = false;          ///< no console output
};

/// Runs a scene to its end. Collective. Returns Finished or Stopped; throws an Error with its exit code otherwise,
/// after saving what can be saved.
ExitCode run_scene(const Comm& comm, const Scene& scene, const RunOptions& options);

/// Version line of the program: version, commit, compiler, libraries.
std::string version_text();
/// Commit the program was built from, with "-dirty" when the sources had been changed; "unknown" outside git.
std::string source_commit();

/// Installs handlers for SIGUSR1 and SIGTERM that ask the run to save and leave.
void install_stop_signals();

}  // namespace stirsph
