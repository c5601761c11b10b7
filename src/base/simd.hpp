/// SIMD lanes. Everything here works for double as well, so that a single material point runs through the same code as
/// a cluster.
#pragma once

#include <cmath>
#include <cstddef>
#include <experimental/simd>
#if defined(__AVX2__) && defined(__x86_64__)
#include <immintrin.h>
#endif

namespace stirsph {

namespace stdx = std::experimental;
using Lanes = stdx::native_simd<double>;
inline constexpr std::size_t lanes = Lanes::size();

/// mask ? a : b, lane by lane.
inline double select(bool mask, double a, double b) { return mask ? a : b; }
inline Lanes select(const Lanes::mask_type& mask, const Lanes& a, Lanes b) {
  stdx::where(mask, b) = a;
  return b;
}

#if defined(__AVX512F__) && defined(__x86_64__)
extern "C" __m512d _ZGVeN8v_exp(__m512d);
extern "C" __m512d _ZGVeN8v_log(__m512d);
extern "C" __m512d _ZGVeN8vv_pow(__m512d, __m512d);
#elif defined(__AVX2__) && defined(__x86_64__)
extern "C" __m256d _ZGVdN4v_exp(__m256d);
extern "C" __m256d _ZGVdN4v_log(__m256d);
extern "C" __m256d _ZGVdN4vv_pow(__m256d, __m256d);
#endif

// e^x, ln x and x^y, with glibc's vector functions (at most 4 units in the last place off) where the lanes are as wide
// as those.
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

inline double logarithm(double x) { return std::log(x); }
inline Lanes logarithm(const Lanes& x) {
#if defined(__AVX512F__) && defined(__x86_64__)
  return Lanes(_ZGVeN8v_log(static_cast<__m512d>(x)));
#elif defined(__AVX2__) && defined(__x86_64__)
  return Lanes(_ZGVdN4v_log(static_cast<__m256d>(x)));
#else
  return stdx::log(x);
#endif
}

inline double power(double x, double y) { return std::pow(x, y); }
inline Lanes power(const Lanes& x, double y) {
#if defined(__AVX512F__) && defined(__x86_64__)
  return Lanes(_ZGVeN8vv_pow(static_cast<__m512d>(x), static_cast<__m512d>(Lanes(y))));
#elif defined(__AVX2__) && defined(__x86_64__)
  return Lanes(_ZGVdN4vv_pow(static_cast<__m256d>(x), static_cast<__m256d>(Lanes(y))));
#else
  return stdx::pow(x, Lanes(y));
#endif
}

/// The first `count` lanes from memory, the others `fill`; and back.
inline Lanes load_lanes(const double* from, std::size_t count, double fill) {
  if (count >= lanes) return Lanes(from, stdx::element_aligned);
  return Lanes([&](auto lane) { return lane < count ? from[lane] : fill; });
}
inline void store_lanes(const Lanes& values, double* to, std::size_t count) {
  if (count >= lanes) {
    values.copy_to(to, stdx::element_aligned);
  } else {
    for (std::size_t lane = 0; lane < count; ++lane) to[lane] = values[lane];
  }
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

}  // namespace stirsph
