/// Values recorded in the history: point interpolation, statistics over sets, extents.
#pragma once

#include <vector>

#include "driver/simulation.hpp"

namespace stirsph {

/// One value per [[probe]] of the scene. Collective. A probe without any particle gives NaN.
std::vector<double> evaluate_probes(const Simulation& simulation);

/// SI unit of a probe's value.
std::string probe_unit(const Scene& scene, const ProbeScene& probe);

/// SI unit of a particle field or derived quantity.
std::string unit_of(const Scene& scene, const std::string& name);

/// Throws InputError for probes, tracers and snapshots of fields the scene does not have.
void check_field_names(const Simulation& simulation);

/// Length [m] of unbroken material beyond a rigid body's reference point, against its direction of motion: bins one
/// spacing wide, counted while each holds at least a quarter as many particles as the fullest. Collective.
double extruded_length(const Simulation& simulation, int rigid);

}  // namespace stirsph
