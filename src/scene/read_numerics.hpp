/// Reads the table [numerics] of a scene file and refuses choices that contradict each other.
#pragma once

#include "input/parameters.hpp"
#include "scene/scene.hpp"

namespace stirsph {

/// `root`: the whole file. Needs the space of the scene, fills its numerics and what else [numerics] decides. Throws
/// InputError.
void read_numerics(const input::Parameters& root, Scene& scene);

}  // namespace stirsph
