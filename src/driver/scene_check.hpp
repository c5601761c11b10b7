/// `stirsph check`: what a scene would run, without running it; and the parameter manual.
#pragma once

#include <string>

#include "base/comm.hpp"
#include "scene/scene.hpp"

namespace stirsph {

/// Space, modules on and off, particles, step and what limits it, memory, predicted wall time (from a short measurement
/// of the pair sweeps on this machine). Builds the initial state, so errors of the scene show here too. Collective.
std::string check_scene(const Comm& comm, const Scene& scene);

/// The parameter manual of scene and material files, Markdown.
std::string parameter_manual();

}  // namespace stirsph
