/// SIMD lanes and tiny matrices over them. Everything here works for double as well, so that a single material point
/// runs through the same code as a cluster.
#pragma once

#include <cmath>
#include <cstddef>
#include <experimental/simd>
#if defined(__AVX2__) && defined(__x86_64__)
#include <immintrin.h>
#endif

#include "base/tensor.hpp"
#include "particles/particle_set.hpp"

namespace stirsph {

namespace stdx = std::experimental;
using Lanes = stdx::native_simd<double>;
inline constexpr std::size_t lanes = Lanes::size();
static_assert(cluster_size % lanes == 0, "a cluster is a whole number of SIMD registers");

/// mask ? a : b, lane by lane.
inline double select(bool mask, double a, double b) { return mask ? a : b; }
inline Lanes select(const Lanes::mask_type& mask, const Lanes& a, Lanes b) {
  stdx::where(mask, b) = a;
  return b;
}

#if defined(__AVX512F__) && defined(__x86_64__)
extern "C" __m512d _ZGVeN8v_exp(__m512d);
#elif defined(__AVX2__) && defined(__x86_64__)
extern "C" __m256d _ZGVdN4v_exp(__m256d);
#endif

/// e^x, with glibc's vector functions (at most 4 units in the last place off) where the lanes are as wide as those.
inline double exponential(double x) { return std::exp(x); }
inline Lanes exponential(const Lanes& x) {
#if defined(__AVX512F__) && defined(__x86_64__)
  return Lanes(_ZGVeN8v_exp(static_cast<__m512d>(x)));
#elif defined(__AVX2__) && defined(__x86_64__)
  return Lanes(_ZGVdN4v_exp(static_cast<__m256d>(x)));
#else
  return stdx::exp(x);
#endif
}

/// The sums over the lanes of `lanes` registers, which stand one behind the other in `rows`; in a fixed order.
inline void sum_rows(const double* rows, double* sums) {
#if defined(__AVX512F__) && defined(__x86_64__)
  const auto row = [&](int k) { return _mm512_load_pd(rows + 8 * k); };
  const auto pair = [](__m512d a, __m512d b) {
    return _mm512_add_pd(_mm512_unpacklo_pd(a, b), _mm512_unpackhi_pd(a, b));
  };
  const auto halve = [](__m512d a, __m512d b) {
    return _mm512_add_pd(_mm512_shuffle_f64x2(a, b, 0x88), _mm512_shuffle_f64x2(a, b, 0xdd));
  };
  _mm512_store_pd(sums, halve(halve(pair(row(0), row(1)), pair(row(2), row(3))),
                              halve(pair(row(4), row(5)), pair(row(6), row(7)))));
#elif defined(__AVX2__) && defined(__x86_64__)
  const auto row = [&](int k) { return _mm256_load_pd(rows + 4 * k); };
  const __m256d a = _mm256_hadd_pd(row(0), row(1)), b = _mm256_hadd_pd(row(2), row(3));
  _mm256_store_pd(sums, _mm256_add_pd(_mm256_permute2f128_pd(a, b, 0x20), _mm256_permute2f128_pd(a, b, 0x31)));
#else
  for (std::size_t k = 0; k < lanes; ++k) {
    sums[k] = 0;
    for (std::size_t lane = 0; lane < lanes; ++lane) sums[k] += rows[k * lanes + lane];
  }
#endif
}

/// A row-major N x N matrix of doubles or lanes.
template <class T, int N>
struct LaneMatrix {
  T a[N][N];
};

template <class T, int N>
LaneMatrix<T, N> multiply(const LaneMatrix<T, N>& a, const LaneMatrix<T, N>& b) {
  LaneMatrix<T, N> c;
  for (int i = 0; i < N; ++i)
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
