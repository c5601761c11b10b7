/// The fixed scenes of stirsph_bench: the same physics and proportions at any number of particles.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "scene/scene.hpp"

namespace stirsph::bench {

struct SceneChoice {
  std::string name;
  std::int64_t particles = 0;                             ///< about; 0 = the scene's own number
  std::optional<GradientCorrection> gradient_correction;  ///< empty: none, in the extrusion that of the velocity
};

/// block, stirred, extrusion, small, taylor.
const std::vector<std::string>& scene_names();

/// block: elastoplastic Johnson-Cook cube, squeezed and spun so that 9 of 10 particles yield (263,088 asked for,
/// 64^3 made). small: the same as a box 2:3:4 of 3,000 particles.
/// stirred: billet of 263,088 particles of which the tool's 1500 rpm decay over 2 mm of depth, dt = 1.6e-5 s.
/// extrusion: mid-process, hot billet and half of the tube in the die, tool under force control, friction, adiabatic.
/// taylor: copper bar of 200 m/s on its held bottom, the case of the published rates of other codes.
Scene bench_scene(const SceneChoice& choice);

}  // namespace stirsph::bench
