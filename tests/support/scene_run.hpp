/// Runs an ordinary scene file inside a test: what a user could do from the command line, with access to the state.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "driver/diagnostics.hpp"
#include "driver/simulation.hpp"
#include "particles/field_names.hpp"
#include "scene/scene.hpp"

namespace stirsph::testing {

inline std::string verification_scene(const std::string& name) {
  return std::string(STIRSPH_SOURCE_DIR) + "/tests/verification/scenes/" + name + ".toml";
}

/// A started simulation of a scene file.
inline std::unique_ptr<Simulation> started(const std::string& path, const std::vector<std::string>& overrides = {},
                                           Comm comm = Comm()) {
  auto simulation = std::make_unique<Simulation>(comm, read_scene(path, overrides));
  simulation->start();
  return simulation;
}

/// Steps to the end of the scene; `each` is called after every step.
inline void run_to_end(
    Simulation& simulation, const std::function<void()>& each = [] {}) {
  while (!simulation.finished()) {
    simulation.step();
    each();
  }
}

/// The values of one component of a field over all ranks, indexed by global particle id.
inline std::vector<double> gathered(const Simulation& simulation, const FieldInfo& info, int component = 0) {
  const ParticleSet& particles = simulation.particles();
  std::vector<double> values(static_cast<std::size_t>(simulation.particle_count()), 0.0);
  for (std::size_t i = 0; i < particles.owned(); ++i)
    values[static_cast<std::size_t>(particles[field::id][i])] = particles.component(info, component)[i];
  simulation.comm().sum_in_place(values);
  return values;
}

}  // namespace stirsph::testing
