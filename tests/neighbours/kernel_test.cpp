/// Smoothing kernels: lattice sums of the verification catalogue (A1), normalisation, slope, SIMD lanes.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>

#include "base/simd.hpp"
#include "neighbours/smoothing_kernel.hpp"

namespace stirsph {
namespace {

/// Sums over a simple cubic lattice of spacing dx around the origin particle: S = sum V W with the particle itself and
/// the diagonal of M = sum V (x_j - x_i) (x) grad_i W. The first `cut` directions have neighbours on one side only.
struct Sums {
  double unity = 0;
  std::array<double, 3> moment{};
};
template <class K>
Sums lattice_sums(double h_over_dx, int cut) {
  constexpr double dx = 0.4e-3;
  const double h = h_over_dx * dx, volume = dx * dx * dx;
  const int n = static_cast<int>(std::ceil(K::support * h_over_dx));
  Sums sums;
  for (int i = cut > 0 ? 0 : -n; i <= n; ++i)
    for (int j = cut > 1 ? 0 : -n; j <= n; ++j)
      for (int k = cut > 2 ? 0 : -n; k <= n; ++k) {
        const std::array<double, 3> d{i * dx, j * dx, k * dx};  // x_j - x_i
        const double r = std::sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
        sums.unity += volume * kernel_value<K>(r, h, 3);
        // grad_i W = W' (x_i - x_j)/r
        if (r > 0)
          for (int a = 0; a < 3; ++a) sums.moment[a] -= volume * d[a] * d[a] * kernel_slope<K>(r, h, 3) / r;
      }
  return sums;
}

/// One row of the catalogue's table A1.
struct Row {
  double h_over_dx, unity, moment, unity_face, moment_normal, moment_tangential, unity_edge, unity_corner;
  double bulk_digits;  ///< half a unit of the last digit printed for the bulk
};
template <class K>
void check(const Row& row) {
  SCOPED_TRACE(std::string(K::keyword) + " h/dx " + std::to_string(row.h_over_dx));
  constexpr double tolerance = 1e-6;  // catalogue; the table itself has six decimals
  const Sums bulk = lattice_sums<K>(row.h_over_dx, 0), face = lattice_sums<K>(row.h_over_dx, 1),
             edge = lattice_sums<K>(row.h_over_dx, 2), corner = lattice_sums<K>(row.h_over_dx, 3);
  EXPECT_NEAR(bulk.unity - 1, row.unity, row.bulk_digits);
  for (double m : bulk.moment) EXPECT_NEAR(m - 1, row.moment, row.bulk_digits);
  EXPECT_NEAR(face.unity, row.unity_face, tolerance);
  EXPECT_NEAR(face.moment[0], row.moment_normal, tolerance);
  EXPECT_NEAR(face.moment[1], row.moment_tangential, tolerance);
  EXPECT_NEAR(face.moment[2], row.moment_tangential, tolerance);
  EXPECT_NEAR(edge.unity, row.unity_edge, tolerance);
  EXPECT_NEAR(corner.unity, row.unity_corner, tolerance);
  std::printf("%-11.*s %.1f  S-1 %.6e  M-1 %.6e  face %.6f  edge %.6f  corner %.6f\n", int(K::keyword.size()),
              K::keyword.data(), row.h_over_dx, bulk.unity - 1, bulk.moment[0] - 1, face.unity, edge.unity,
              corner.unity);
}

TEST(KernelLatticeSums, TableA1) {
  check<CubicSpline>({1.3, -2.738172e-3, -6.516300e-3, 0.767847, 0.496742, 0.768811, 0.589408, 0.450994, 1e-9});
  check<CubicSpline>({1.2, +8.095484e-4, -1.831143e-2, 0.792001, 0.490844, 0.779826, 0.624841, 0.491388, 1e-8});
  check<WendlandC2>({1.5, +3.141083e-3, +6.193001e-4, 0.752856, 0.500310, 0.749659, 0.564347, 0.422744, 1e-9});
  check<WendlandC2>({2.0, +5.486164e-4, -5.872911e-4, 0.688000, 0.499706, 0.687056, 0.472746, 0.324716, 1e-9});
  check<QuinticSpline>({1.0, -2.004e-5, +1.001281e-3, 0.784532, 0.500501, 0.785251, 0.614114, 0.479654, 1e-8});
}

/// Five-point Gauss-Legendre over pieces of length 1/16: the splines' knots are piece borders, so only round-off is
/// left.
template <class F>
double integrate(F&& f, double from, double to) {
  constexpr std::array<double, 5> x{0, 0.5384693101056831, -0.5384693101056831, 0.9061798459386640,
                                    -0.9061798459386640};
  constexpr std::array<double, 5> w{0.5688888888888889, 0.4786286704993665, 0.4786286704993665, 0.2369268850561891,
                                    0.2369268850561891};
  const int pieces = static_cast<int>(std::lround((to - from) * 16));
  double sum = 0;
  for (int p = 0; p < pieces; ++p)
    for (int k = 0; k < 5; ++k) sum += w[k] / 32 * f(from + (p + 0.5 + 0.5 * x[k]) / 16);
  return sum;
}

template <class K>
class KernelTest : public ::testing::Test {};
using Kernels = ::testing::Types<CubicSpline, WendlandC2, WendlandC4, QuinticSpline>;
TYPED_TEST_SUITE(KernelTest, Kernels);

TYPED_TEST(KernelTest, IntegralIsOne) {
  using K = TypeParam;
  constexpr double h = 0.52e-3;
  const double plane = integrate(
      [&](double q) { return 2 * std::numbers::pi * q * h * h * kernel_value<K>(q * h, h, 2); }, 0, K::support);
  const double space = integrate(
      [&](double q) { return 4 * std::numbers::pi * q * q * h * h * h * kernel_value<K>(q * h, h, 3); }, 0, K::support);
  std::printf("%.*s: integral - 1 = %.1e in 2-D, %.1e in 3-D\n", int(K::keyword.size()), K::keyword.data(), plane - 1,
              space - 1);
  // Round-off of some hundred terms; measured 7e-16.
  EXPECT_NEAR(plane, 1, 1e-13);
  EXPECT_NEAR(space, 1, 1e-13);
}

TYPED_TEST(KernelTest, FirstMomentOfTheSlopeIsOne) {
  // Integration by parts: -1/d times the integral of r W' over space is the integral of W, so 1.
  using K = TypeParam;
  constexpr double h = 0.52e-3;
  const double plane = integrate(
      [&](double q) { return -std::numbers::pi * q * q * h * h * h * kernel_slope<K>(q * h, h, 2); }, 0, K::support);
  const double space = integrate(
      [&](double q) { return -4.0 / 3 * std::numbers::pi * q * q * q * h * h * h * h * kernel_slope<K>(q * h, h, 3); },
      0, K::support);
  EXPECT_NEAR(plane, 1, 1e-13);
  EXPECT_NEAR(space, 1, 1e-13);
}

TYPED_TEST(KernelTest, SlopeIsTheDerivativeOfTheValue) {
  using K = TypeParam;
  constexpr double h = 1.7, step = 1e-5;
  for (int dim : {2, 3}) {
    const double scale = kernel_value<K>(0, h, dim) / h;
    double worst = 0;
    for (double q = 0.01; q < K::support + 0.2; q += 0.013) {
      const double difference =
          (kernel_value<K>((q + step) * h, h, dim) - kernel_value<K>((q - step) * h, h, dim)) / (2 * step * h);
      worst = std::max(worst, std::abs(kernel_slope<K>(q * h, h, dim) - difference) / scale);
    }
    std::printf("%.*s, %d-D: largest difference %.1e\n", int(K::keyword.size()), K::keyword.data(), dim, worst);
    EXPECT_LT(worst, 1e-9);  // truncation step^2 and round-off 1e-16/step; measured 2.6e-10
  }
}

TYPED_TEST(KernelTest, CompactPositiveAndFalling) {
  using K = TypeParam;
  EXPECT_EQ(K::slope(0.0), 0.0);
  for (double q = 0.01; q < K::support; q += 0.01) {
    EXPECT_GT(K::value(q), -1e-14);  // the splines cancel near the edge of the support
    EXPECT_LT(K::slope(q), 1e-13);
  }
  for (double q : {K::support, K::support + 1e-9, K::support + 3.0}) {
    EXPECT_EQ(K::value(q), 0.0);
    EXPECT_EQ(K::slope(q), 0.0);
  }
}

TYPED_TEST(KernelTest, LanesGiveTheScalarValues) {
  using K = TypeParam;
  for (double start = 0; start < K::support + 0.3; start += 0.011) {
    const Lanes q([&](auto lane) { return start + 0.003 * static_cast<double>(lane); });
    const Lanes value = K::value(q), slope = K::slope(q);
    for (std::size_t k = 0; k < lanes; ++k) {
      // Contraction to fused multiply-add may differ; the largest terms are of order 100 (quintic).
      EXPECT_NEAR(value[k], K::value(q[k]), 1e-13);
      EXPECT_NEAR(slope[k], K::slope(q[k]), 1e-12);
    }
  }
}

}  // namespace
}  // namespace stirsph
