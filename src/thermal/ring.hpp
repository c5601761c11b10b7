/// Particles and areas of the axisymmetric space as rings: what turns the formulas of the plane into those of rings.
#pragma once

#include <cmath>
#include <numbers>
#include <vector>

#include "particles/field_names.hpp"
#include "particles/particle_set.hpp"

namespace stirsph {

/// Halo copies that stand for the far side of the axis have a negative radius. The thermal code makes such images
/// itself where it needs them, and passes these by.
inline bool is_mirror_image(double radius) { return radius < 0; }

/// Length [m] of the circle of this radius.
inline double circumference(double radius) { return 2 * std::numbers::pi * std::abs(radius); }

/// Section area [m2] of every particle in the half-plane, halo copies included.
inline std::vector<double> ring_sections(const ParticleSet& particles) {
  const auto radius = particles.component(field::position, 0), volume = particles[field::volume];
  std::vector<double> sections(particles.total());
  for (std::size_t i = 0; i < sections.size(); ++i) sections[i] = volume[i] / circumference(radius[i]);
  return sections;
}

}  // namespace stirsph
