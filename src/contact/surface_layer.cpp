#include "contact/surface_layer.hpp"

#include <algorithm>
#include <cmath>

#include "base/tensor.hpp"

namespace stirsph {

namespace {

template <int dim>
using Square = std::array<std::array<double, dim>, dim>;

double determinant(const Square<2>& m) { return m[0][0] * m[1][1] - m[0][1] * m[1][0]; }
double determinant(const Square<3>& m) {
  return m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) - m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
         m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
}

/// The factor of each direction in a factor of all `dim` of them.
template <int dim>
double per_direction(double factor) {
  return dim == 2 ? std::sqrt(factor) : std::cbrt(factor);
}

/// b = (1 + dt L) b (1 + dt L)^T.
template <int dim>
void deform(const LayerArrays& arrays, double dt) {
  const LayerArrays::Matrix<double> stretch = arrays.stretch;
  const LayerArrays::Matrix<const double> gradient = arrays.velocity_gradient;
#pragma GCC ivdep
  for (std::size_t i = 0; i < arrays.owned; ++i) {
    Square<dim> step{}, half{};
    for (int a = 0; a < dim; ++a)
      for (int b = 0; b < dim; ++b) step[a][b] = dt * gradient[a][b][i] + (a == b ? 1.0 : 0.0);
    for (int a = 0; a < dim; ++a)
      for (int b = 0; b < dim; ++b)
        for (int c = 0; c < dim; ++c) half[a][b] += step[a][c] * stretch[c][b][i];
    for (int a = 0; a < dim; ++a)
      for (int b = a; b < dim; ++b) {
        double next = 0;
        for (int c = 0; c < dim; ++c) next += half[a][c] * step[b][c];
        stretch[a][b][i] = next;
      }
  }
}

/// Where metal flows, b goes towards the isotropic tensor of its volume, which it keeps.
template <int dim>
void forget(const LayerArrays& arrays, double dt) {
  const LayerArrays::Matrix<double>& stretch = arrays.stretch;
  for (std::size_t i = 0; i < arrays.owned; ++i) {
    const double strain = arrays.plastic_strain_rate[i] * dt;
    if (strain == 0) continue;
    const double forgotten = strain / (1 + strain);  // implicit: stable at any strain of a step
    Square<dim> b{};
    for (int row = 0; row < dim; ++row)
      for (int column = 0; column < dim; ++column) b[row][column] = stretch[row][column][i];
    const double volume = determinant(b), isotropic = per_direction<dim>(volume);
    for (int row = 0; row < dim; ++row)
      for (int column = 0; column < dim; ++column)
        b[row][column] += forgotten * ((row == column ? isotropic : 0.0) - b[row][column]);
    const double keep_volume = per_direction<dim>(volume / determinant(b));
    for (int row = 0; row < dim; ++row)
      for (int column = row; column < dim; ++column) stretch[row][column][i] = keep_volume * b[row][column];
  }
}

}  // namespace

void SurfaceLayer::initialise(ParticleSet& particles) const {
  for (int a = 0; a < layout_.dim; ++a)
    std::ranges::fill(particles.component(field::layer_stretch, layout_.axes[a]), 1.0);
}

LayerArrays SurfaceLayer::arrays(ParticleSet& particles) const {
  LayerArrays arrays;
  const int dim = layout_.dim;
  for (int a = 0; a < dim; ++a)
    for (int b = 0; b < dim; ++b) {
      const int row = layout_.axes[a], column = layout_.axes[b];
      const int symmetric = symmetric_index(std::min(row, column), std::max(row, column)), in_space = row * dim + b;
      arrays.stretch[a][b] = particles.component(field::layer_stretch, symmetric).data();
      arrays.moment[a][b] = particles.component(field::layer_moment, symmetric).data();
      arrays.corrected_stress[a][b] = particles.component(field::corrected_stress, in_space).data();
      arrays.velocity_gradient[a][b] = particles.component(field::velocity_gradient, in_space).data();
      arrays.inverse_moment[a][b] = particles.component(field::inverse_moment, in_space).data();
    }
  arrays.volume = particles[field::volume].data();
  arrays.plastic_strain_rate = particles[field::plastic_strain_rate].data();
  arrays.owned = particles.owned();
  return arrays;
}

void SurfaceLayer::advance(const LayerArrays& arrays, double dt) const {
  if (layout_.dim == 2) {
    deform<2>(arrays, dt);
    forget<2>(arrays, dt);
  } else {
    deform<3>(arrays, dt);
    forget<3>(arrays, dt);
  }
}

template <class T>
double SurfaceLayer::along(const LayerArrays::Matrix<T>& tensor, std::size_t i, const Vec3& n) const {
  double sum = 0;
  for (int a = 0; a < layout_.dim; ++a)
    for (int b = 0; b < layout_.dim; ++b) sum += n[layout_.axes[a]] * tensor[a][b][i] * n[layout_.axes[b]];
  return sum;
}

double SurfaceLayer::thickness(const LayerArrays& arrays, std::size_t i, const Vec3& n) const {
  const double square = along(arrays.stretch, i, n);
  return std::clamp(std::sqrt(std::max(square, 0.0)), thinnest_layer, thickest_layer) * half_;
}

double SurfaceLayer::opening(const LayerArrays& arrays, std::size_t i, const Vec3& n, double thickness) const {
  return thickness * along(arrays.velocity_gradient, i, n);
}

void SurfaceLayer::unload(const LayerArrays& arrays) const {
  for (int a = 0; a < layout_.dim; ++a)
    for (int b = a; b < layout_.dim; ++b) std::fill_n(arrays.moment[a][b], arrays.owned, 0.0);
}

double SurfaceLayer::power(const LayerArrays& arrays) const {
  double power = 0;
  for (int a = 0; a < layout_.dim; ++a)
    for (int b = 0; b < layout_.dim; ++b)
      for (std::size_t i = 0; i < arrays.owned; ++i)
        power += arrays.moment[a][b][i] * arrays.velocity_gradient[a][b][i];
  return power;
}

void SurfaceLayer::load(const LayerArrays& arrays, std::size_t i, const Vec3& n, double thickness, double force) const {
  const int dim = layout_.dim;
  const double moment = thickness * force, stress = moment / arrays.volume[i];
  for (int b = 0; b < dim; ++b) {
    for (int a = 0; a <= b; ++a) arrays.moment[a][b][i] += moment * n[layout_.axes[a]] * n[layout_.axes[b]];
    double corrected = 0;
    for (int c = 0; c < dim; ++c) corrected += n[layout_.axes[c]] * arrays.inverse_moment[c][b][i];
    for (int a = 0; a < dim; ++a) arrays.corrected_stress[a][b][i] += stress * n[layout_.axes[a]] * corrected;
  }
}

}  // namespace stirsph
