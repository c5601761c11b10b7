/// How far alloys have spread and how well they are mixed.
#pragma once

#include "driver/simulation.hpp"

namespace stirsph {

/// Lacey's mixing index (s0^2 - s^2)/(s0^2 - sr^2) of a set (-1: all particles) [1]: s^2 is the variance of the local
/// composition, smoothed with the scene's kernel over the neighbours, s0^2 that of separated and sr^2 that expected of
/// randomly mixed materials (bodies when `by_body`), variances of several components added. Particles count with their
/// mass. 0 separated, about 1 mixed at random. NaN if the set holds one component only. The neighbours' halo copies
/// must be up to date, as they are after a step. Collective.
/// Source: P. M. C. Lacey, Developments in the theory of particle mixing, J. appl. Chem. 4 (1954) 257-268.
double mixing_index(const Simulation& simulation, int set, bool by_body);

/// Circular variance [1] of the angles of a set about the z axis, 1 - |mean of exp(i angle)|: 0 at one angle, 1 evenly
/// around. NaN for an empty set. Collective. Source: Mardia, Jupp, Directional Statistics (2000), section 2.3.
double angular_spread(const Simulation& simulation, int set);

/// Whether a particle belongs to a set; -1: always.
bool in_set(const ParticleSet& particles, int set, std::size_t i);

}  // namespace stirsph
