/// Tiny matrices over doubles or SIMD lanes.
#pragma once

#include "base/simd.hpp"

namespace stirsph {

/// A row-major M x N matrix of doubles or lanes; square unless N is given.
template <class T, int M, int N = M>
struct LaneMatrix {
  T a[M][N];
};

template <class T, int M, int N>
LaneMatrix<T, M, N> multiply(const LaneMatrix<T, M, N>& a, const LaneMatrix<T, N>& b) {
  LaneMatrix<T, M, N> c;
  for (int i = 0; i < M; ++i)
    for (int j = 0; j < N; ++j) {
      T sum = a.a[i][0] * b.a[0][j];
      for (int k = 1; k < N; ++k) sum += a.a[i][k] * b.a[k][j];
      c.a[i][j] = sum;
    }
  return c;
}

template <class T>
T determinant(const LaneMatrix<T, 2>& m) {
  return m.a[0][0] * m.a[1][1] - m.a[0][1] * m.a[1][0];
}
template <class T>
T determinant(const LaneMatrix<T, 3>& m) {
  return m.a[0][0] * (m.a[1][1] * m.a[2][2] - m.a[1][2] * m.a[2][1]) -
         m.a[0][1] * (m.a[1][0] * m.a[2][2] - m.a[1][2] * m.a[2][0]) +
         m.a[0][2] * (m.a[1][0] * m.a[2][1] - m.a[1][1] * m.a[2][0]);
}

/// Transposed cofactors: inverse = adjugate/determinant.
template <class T>
LaneMatrix<T, 2> adjugate(const LaneMatrix<T, 2>& m) {
  return {{{m.a[1][1], -m.a[0][1]}, {-m.a[1][0], m.a[0][0]}}};
}
template <class T>
LaneMatrix<T, 3> adjugate(const LaneMatrix<T, 3>& m) {
  LaneMatrix<T, 3> r;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      const int i1 = (i + 1) % 3, i2 = (i + 2) % 3, j1 = (j + 1) % 3, j2 = (j + 2) % 3;
      r.a[j][i] = m.a[i1][j1] * m.a[i2][j2] - m.a[i1][j2] * m.a[i2][j1];
    }
  return r;
}

}  // namespace stirsph
