#include "contact/surface_layer.hpp"

#include <algorithm>
#include <cmath>

#include "base/tensor.hpp"
#include "particles/field_names.hpp"

namespace stirsph {

namespace {

using Square = std::array<std::array<double, 3>, 3>;  ///< by components of a position

int slot(const SpaceLayout& layout, int i, int j) {
  return symmetric_index(std::min(layout.axes[i], layout.axes[j]), std::max(layout.axes[i], layout.axes[j]));
}

Square velocity_gradient(const ParticleSet& particles, const SpaceLayout& layout, std::size_t i) {
  Square gradient{};
  for (int a = 0; a < layout.dim; ++a)
    for (int b = 0; b < layout.dim; ++b)
      gradient[a][b] = particles.component(field::velocity_gradient, layout.axes[a] * layout.dim + b)[i];
  return gradient;
}

/// Determinant of the part of a space's dimensions.
double determinant(const Square& m, int dim) {
  if (dim == 2) return m[0][0] * m[1][1] - m[0][1] * m[1][0];
  return m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) - m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
         m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
}

}  // namespace

void SurfaceLayer::initialise(ParticleSet& particles) const {
  for (int a = 0; a < layout_.dim; ++a) {
    const auto diagonal = particles.component(field::layer_stretch, slot(layout_, a, a));
    std::fill(diagonal.begin(), diagonal.end(), 1.0);
  }
}

void SurfaceLayer::advance(ParticleSet& particles, double dt) const {
  const int dim = layout_.dim;
  const auto plastic_rate = particles[field::plastic_strain_rate];
  std::array<std::array<double*, 3>, 3> stretch{};
  for (int a = 0; a < dim; ++a)
    for (int b = 0; b < dim; ++b) stretch[a][b] = particles.component(field::layer_stretch, slot(layout_, a, b)).data();
  for (std::size_t i = 0; i < particles.owned(); ++i) {
    Square step = velocity_gradient(particles, layout_, i), half{}, next{};
    for (int a = 0; a < dim; ++a)
      for (int b = 0; b < dim; ++b) step[a][b] = dt * step[a][b] + (a == b ? 1.0 : 0.0);
    for (int a = 0; a < dim; ++a)
      for (int b = 0; b < dim; ++b)
        for (int c = 0; c < dim; ++c) half[a][b] += step[a][c] * stretch[c][b][i];
    for (int a = 0; a < dim; ++a)
      for (int b = 0; b < dim; ++b)
        for (int c = 0; c < dim; ++c) next[a][b] += half[a][c] * step[b][c];
    const double forgotten = 1 - std::exp(-plastic_rate[i] * dt), volume = determinant(next, dim),
                 isotropic = std::pow(volume, 1.0 / dim);
    for (int a = 0; a < dim; ++a)
      for (int b = 0; b < dim; ++b) next[a][b] += forgotten * ((a == b ? isotropic : 0.0) - next[a][b]);
    const double keep_volume = forgotten > 0 ? std::pow(volume / determinant(next, dim), 1.0 / dim) : 1.0;
    for (int a = 0; a < dim; ++a)
      for (int b = a; b < dim; ++b) stretch[a][b][i] = keep_volume * next[a][b];
  }
}

double SurfaceLayer::thickness(const ParticleSet& particles, std::size_t i, const Vec3& n) const {
  double square = 0;
  for (int a = 0; a < layout_.dim; ++a)
    for (int b = 0; b < layout_.dim; ++b)
      square +=
          n[layout_.axes[a]] * n[layout_.axes[b]] * particles.component(field::layer_stretch, slot(layout_, a, b))[i];
  return std::clamp(std::sqrt(std::max(square, 0.0)), thinnest_layer, thickest_layer) * half_;
}

double SurfaceLayer::opening(const ParticleSet& particles, std::size_t i, const Vec3& n, double thickness) const {
  const Square gradient = velocity_gradient(particles, layout_, i);
  double rate = 0;
  for (int a = 0; a < layout_.dim; ++a)
    for (int b = 0; b < layout_.dim; ++b) rate += n[layout_.axes[a]] * gradient[a][b] * n[layout_.axes[b]];
  return thickness * rate;
}

void SurfaceLayer::unload(ParticleSet& particles) const {
  for (int a = 0; a < layout_.dim; ++a)
    for (int b = a; b < layout_.dim; ++b) {
      const auto moment = particles.component(field::layer_moment, slot(layout_, a, b));
      std::fill(moment.begin(), moment.end(), 0.0);
    }
}

double SurfaceLayer::power(const ParticleSet& particles) const {
  double power = 0;
  for (int a = 0; a < layout_.dim; ++a)
    for (int b = 0; b < layout_.dim; ++b) {
      const auto moment = particles.component(field::layer_moment, slot(layout_, a, b)),
                 gradient = particles.component(field::velocity_gradient, layout_.axes[a] * layout_.dim + b);
      for (std::size_t i = 0; i < particles.owned(); ++i) power += moment[i] * gradient[i];
    }
  return power;
}

void SurfaceLayer::load(ParticleSet& particles, std::size_t i, const Vec3& n, double thickness, double force) const {
  const int dim = layout_.dim;
  const double moment = thickness * force, stress = moment / particles[field::volume][i];
  for (int b = 0; b < dim; ++b) {
    for (int a = 0; a <= b; ++a)
      particles.component(field::layer_moment, slot(layout_, a, b))[i] +=
          moment * n[layout_.axes[a]] * n[layout_.axes[b]];
    double corrected = 0;
    for (int c = 0; c < dim; ++c)
      corrected += n[layout_.axes[c]] * particles.component(field::inverse_moment, layout_.axes[c] * dim + b)[i];
    for (int a = 0; a < dim; ++a)
      particles.component(field::corrected_stress, layout_.axes[a] * dim + b)[i] +=
          stress * n[layout_.axes[a]] * corrected;
  }
}

}  // namespace stirsph
