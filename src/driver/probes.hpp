/// Values recorded in the history: point interpolation, statistics over sets, extents.
#pragma once

#include <vector>

#include "driver/simulation.hpp"

namespace stirsph {

/// One value per [[probe]] of the scene. Collective. A probe without any particle gives NaN. In the axisymmetric space
/// they mean what they mean in three dimensions: a position is turned into the half-plane, averages are weighted with
/// the volumes of the rings, the extent of the radius is a diameter.
std::vector<double> evaluate_probes(const Simulation& simulation);

/// SI unit of a probe's value.
std::string probe_unit(const Scene& scene, const ProbeScene& probe);

/// SI unit of a particle field or derived quantity.
std::string unit_of(const Scene& scene, const std::string& name);

/// Throws InputError for probes, tracers and snapshots of fields the scene does not have.
void check_field_names(const Simulation& simulation);

/// How many bins from the first on hold unbroken material: each with its two neighbours at least a quarter of what the
/// fullest three together hold. One bin alone would not do: a wall of three rings has slices without any, because rings
/// sit at any height.
std::size_t unbroken_bins(const std::vector<double>& bins);

/// Length [m] of unbroken material beyond a rigid body's reference point, against its direction of motion, to the far
/// surface (half a spacing beyond the centre) of the farthest particle in it. Bins are one spacing wide and count
/// particles, of rings their volume. Collective.
double extruded_length(const Simulation& simulation, int rigid);

}  // namespace stirsph
