#include "mechanics/artificial_stress.hpp"

#include <algorithm>
#include <cmath>

namespace stirsph {
namespace {

/// Cyclic Jacobi: eigenvalues on the diagonal of `m`, eigenvectors in the columns of `axes`.
template <int N>
void diagonalise(Matrix<N>& m, Matrix<N>& axes) {
  axes = {};
  for (int i = 0; i < N; ++i) axes(i, i) = 1;
  double scale = 0;
  for (double value : m.a) scale = std::max(scale, std::abs(value));
  for (int sweep = 0; sweep < 30; ++sweep) {
    double off = 0;
    for (int p = 0; p < N; ++p)
      for (int q = p + 1; q < N; ++q) off = std::max(off, std::abs(m(p, q)));
    if (off <= 1e-15 * scale) return;
    for (int p = 0; p < N; ++p)
      for (int q = p + 1; q < N; ++q) {
        if (m(p, q) == 0) continue;
        const double theta = 0.5 * std::atan2(2 * m(p, q), m(q, q) - m(p, p));
        const double c = std::cos(theta), s = std::sin(theta);
        for (int k = 0; k < N; ++k) {
          const double a = m(k, p), b = m(k, q);
          m(k, p) = c * a - s * b;
          m(k, q) = s * a + c * b;
        }
        for (int k = 0; k < N; ++k) {
          const double a = m(p, k), b = m(q, k);
          m(p, k) = c * a - s * b;
          m(q, k) = s * a + c * b;
        }
        for (int k = 0; k < N; ++k) {
          const double a = axes(k, p), b = axes(k, q);
          axes(k, p) = c * a - s * b;
          axes(k, q) = s * a + c * b;
        }
      }
  }
}

}  // namespace

template <class S>
void artificial_stress(const double* stress, double epsilon, double* artificial) {
  constexpr int dim = S::dim;
  std::fill_n(artificial, S::stress_components, 0.0);
  Matrix<dim> m, axes;
  double largest_radius = 0, largest_diagonal = stress[0];
  for (int i = 0; i < dim; ++i) {
    double radius = 0;
    for (int j = 0; j < dim; ++j) {
      m(i, j) = stress[symmetric_index(std::min(i, j), std::max(i, j))];
      if (i != j) radius += std::abs(m(i, j));
    }
    largest_radius = std::max(largest_radius, radius);
    largest_diagonal = std::max(largest_diagonal, m(i, i));
  }
  // Gershgorin: no eigenvalue can be tensile, which is the common case in an extrusion.
  if (largest_diagonal + largest_radius <= 0) return;
  diagonalise(m, axes);
  for (int i = 0; i < dim; ++i)
    for (int j = i; j < dim; ++j) {
      double sum = 0;
      for (int k = 0; k < dim; ++k) sum -= epsilon * std::max(m(k, k), 0.0) * axes(i, k) * axes(j, k);
      artificial[symmetric_index(i, j)] = sum;
    }
}

template void artificial_stress<Cartesian3>(const double*, double, double*);
template void artificial_stress<PlaneStrain>(const double*, double, double*);

}  // namespace stirsph
