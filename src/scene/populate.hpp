/// Fills the bodies of a scene with particles.
#pragma once

#include "base/comm.hpp"
#include "particles/particle_set.hpp"
#include "scene/scene.hpp"

namespace stirsph {

/// Particles of each body and how well they fill it.
struct BodyCount {
  std::string name;
  std::int64_t particles = 0;
  double mass = 0;  ///< kg; of populate() this rank's share
};

/// Counts without creating anything.
std::vector<BodyCount> count_particles(const Scene& scene);

/// Creates this rank's share of all particles (the caller redistributes them) with position, velocity, mass,
/// temperature, body, material, set membership and a global id that does not depend on the rank count. All fields must
/// have been added. Throws InputError when a body holds no particle.
std::vector<BodyCount> populate(const Scene& scene, const Comm& comm, ParticleSet& particles);

}  // namespace stirsph
