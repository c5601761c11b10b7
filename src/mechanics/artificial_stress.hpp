/// Artificial stress against the tensile instability (Gray, Monaghan & Swift 2001): in principal axes, R = -epsilon
/// sigma for tensile principal stresses, zero for compressive ones. (The paper's 1/rho^2 is absorbed by the volume form
/// of the sweep.)
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "mechanics/lane_matrix.hpp"
#include "particles/space.hpp"

namespace stirsph {

/// Cyclic Jacobi: eigenvalues on the diagonal of the symmetric `m`, eigenvectors in the columns of `axes`. A lane that
/// has converged is turned no further, so that its result does not depend on the others.
template <class T, int N>
void diagonalise(LaneMatrix<T, N>& m, LaneMatrix<T, N>& axes) {
  using std::abs, std::max, std::sqrt;
  T scale = 0.0;
  for (int i = 0; i < N; ++i)
    for (int j = 0; j < N; ++j) {
      axes.a[i][j] = i == j ? 1.0 : 0.0;
      scale = max(scale, T(abs(m.a[i][j])));
    }
  const T negligible = std::numeric_limits<double>::epsilon() * scale;
  constexpr int most_sweeps = 30;  // 5 do; the bound is for values that are no numbers
  for (int sweep = 0; sweep < most_sweeps; ++sweep) {
    bool turned = false;
    for (int p = 0; p < N; ++p)
      for (int q = p + 1; q < N; ++q) {
        const auto turns = T(abs(m.a[p][q])) > negligible;
        if (!any(turns)) continue;
        turned = true;
        // The smaller root of t^2 + 2 t theta = 1, t the tangent of the angle that makes m_pq vanish.
        const T theta = (m.a[q][q] - m.a[p][p]) / (2.0 * select(turns, m.a[p][q], T(1.0)));
        const T root = 1.0 / (abs(theta) + sqrt(T(theta * theta + 1.0)));
        const T t = select(turns, select(theta < T(0.0), T(-root), root), T(0.0));
        const T c = 1.0 / sqrt(T(t * t + 1.0)), s = t * c;
        for (int k = 0; k < N; ++k) {
          const T a = m.a[k][p], b = m.a[k][q];
          m.a[k][p] = c * a - s * b;
          m.a[k][q] = s * a + c * b;
        }
        for (int k = 0; k < N; ++k) {
          const T a = m.a[p][k], b = m.a[q][k];
          m.a[p][k] = c * a - s * b;
          m.a[q][k] = s * a + c * b;
        }
        for (int k = 0; k < N; ++k) {
          const T a = axes.a[k][p], b = axes.a[k][q];
          axes.a[k][p] = c * a - s * b;
          axes.a[k][q] = s * a + c * b;
        }
      }
    if (!turned) return;
  }
}

/// `stress` [Pa] in storage order (its part in the plane of the positions is used); writes the in-space components of
/// `artificial` [Pa] and zeros for the others. T: double or lanes.
template <class S, class T>
void artificial_stress(const T* stress, double epsilon, T* artificial) {
  using std::abs, std::max;
  constexpr int dim = S::dim;
  for (int c = 0; c < S::stress_components; ++c) artificial[c] = 0.0;
  LaneMatrix<T, dim> m, axes;
  T bound = -std::numeric_limits<double>::infinity();
  for (int i = 0; i < dim; ++i) {
    T radius = 0.0;
    for (int j = 0; j < dim; ++j) {
      m.a[i][j] = stress[in_plane_index<S>(std::min(i, j), std::max(i, j))];
      if (i != j) radius += abs(m.a[i][j]);
    }
    bound = max(bound, T(m.a[i][i] + radius));
  }
  // Gershgorin: no eigenvalue can be tensile, which is the common case in an extrusion.
  if (!any(bound > T(0.0))) return;
  diagonalise(m, axes);
  for (int i = 0; i < dim; ++i)
    for (int j = i; j < dim; ++j) {
      T sum = 0.0;
      for (int k = 0; k < dim; ++k) sum -= epsilon * max(m.a[k][k], T(0.0)) * axes.a[i][k] * axes.a[j][k];
      artificial[in_plane_index<S>(i, j)] = sum;
    }
}

}  // namespace stirsph
