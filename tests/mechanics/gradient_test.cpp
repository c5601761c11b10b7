/// Exactness and order of the gradients (A2, A3), and neighbourhoods too poor for a correction.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <vector>

#include "mechanics/sweep_fixture.hpp"

namespace stirsph {
namespace {

using testing::Lattice;
using testing::LatticeBody;
using testing::swept_gradient;

void add_velocity(ParticleSet& particles) { particles.add(field::velocity); }

/// Sets v(x) on owned particles and halo copies.
template <class Function>
void set_velocity(ParticleSet& p, Function&& function) {
  for (std::size_t i = 0; i < p.total(); ++i) {
    const Vec3 v = function(p.vector_at(field::position, i));
    for (int d = 0; d < p.layout().velocity_components; ++d) p.component(field::velocity, d)[i] = v[d];
  }
}

/// The catalogue's function in the first component; two more in the others.
constexpr double slopes[3][3] = {{2, -3, 0.5}, {1, 0, 0}, {-0.3, 0.7, 1.9}};
Vec3 linear(const Vec3& x) {
  Vec3 v{1, 0, -2};
  for (int a = 0; a < 3; ++a)
    for (int b = 0; b < 3; ++b) v[a] += slopes[a][b] * x[b];
  return v;
}

template <class S, class K>
void linear_is_exact(double h_over_dx, double jitter) {
  Lattice lattice;
  lattice.dim = S::dim;
  lattice.count = {11, 10, 9};
  lattice.spacing = 0.1;
  lattice.h_over_dx = h_over_dx;
  lattice.support = K::support;
  lattice.jitter = jitter;
  LatticeBody body(Comm(), lattice, add_velocity);
  set_velocity(body.particles, linear);
  const auto result = swept_gradient<S, K, true>(body.particles, body.pairs, h_over_dx * lattice.spacing);
  double worst = 0;
  for (const auto& gradient : result.gradient)
    for (int a = 0; a < S::dim; ++a)
      for (int b = 0; b < S::dim; ++b) worst = std::max(worst, std::abs(gradient(a, b) - slopes[a][b]));
  std::printf("%.*s %.1f, %d-D, jitter %.1f: largest error %.1e, %ld fallbacks\n", int(K::keyword.size()),
              K::keyword.data(), h_over_dx, S::dim, jitter, worst, result.fallbacks);
  EXPECT_LT(worst, 1e-12);  // catalogue; all particles, so faces, edges and corners are among them
  EXPECT_EQ(result.fallbacks, 0);
}

TEST(CorrectedGradient, IsExactOnLinearFieldsEverywhere) {
  for (double jitter : {0.0, 0.2}) {
    linear_is_exact<Cartesian3, CubicSpline>(1.3, jitter);
    linear_is_exact<Cartesian3, WendlandC2>(1.5, jitter);
    linear_is_exact<Cartesian3, WendlandC4>(2.0, jitter);
    linear_is_exact<Cartesian3, QuinticSpline>(1.0, jitter);
    linear_is_exact<PlaneStrain, CubicSpline>(1.3, jitter);
    linear_is_exact<PlaneStrain, QuinticSpline>(1.0, jitter);
  }
}

/// Rms over interior particles of the error of grad x (all its components together) of the plain difference form.
template <class K>
double plain_error(double h_over_dx) {
  Lattice lattice;
  lattice.count = {24, 24, 24};
  lattice.h_over_dx = h_over_dx;
  lattice.support = K::support;
  lattice.jitter = 0.2;
  LatticeBody body(Comm(), lattice, add_velocity);
  ParticleSet& p = body.particles;
  set_velocity(p, [](const Vec3& x) { return x; });
  const auto result = swept_gradient<Cartesian3, K, false>(p, body.pairs, h_over_dx);
  double sum = 0, n = 0;
  for (std::size_t i = 0; i < p.owned(); ++i) {
    const Vec3 x = p.vector_at(field::position, i);
    bool inside = true;
    for (int d = 0; d < 3; ++d) inside = inside && x[d] > 4 && x[d] < 20;
    if (!inside) continue;
    // One row: the gradient of the field x should be (1, 0, 0).
    for (int b = 0; b < 3; ++b) sum += std::pow(result.gradient[i](0, b) - (b == 0), 2);
    n += 1;
  }
  return std::sqrt(Comm().sum(sum) / Comm().sum(n));
}

TEST(PlainGradient, ErrorOnTheJitteredLatticeAsInTheCatalogue) {
  // Catalogue A2, within 10 %; for Wendland C2 its 0.067 could not be reproduced: a plain double loop outside this code
  // over 216 particles gives 0.0546 (and 0.0671 for the cubic).
  struct Row {
    const char* name;
    double measured, reference;
  };
  for (const Row& row : {Row{"cubic 1.3", plain_error<CubicSpline>(1.3), 0.067},
                         Row{"wendland_c2 1.5", plain_error<WendlandC2>(1.5), 0.0546},
                         Row{"quintic 1.0", plain_error<QuinticSpline>(1.0), 0.072}}) {
    std::printf("%s: rms error of grad x %.4f (catalogue %.3f)\n", row.name, row.measured, row.reference);
    EXPECT_NEAR(row.measured / row.reference, 1, 0.1) << row.name;
  }
}

/// Errors of the corrected gradient of x^2 on a jittered unit cube with n particles a side: rms and largest, relative
/// to the largest gradient 2.
template <class K>
std::array<double, 2> quadratic_error(int n, double h_over_dx) {
  Lattice lattice;
  lattice.count = {n, n, n};
  lattice.spacing = 1.0 / n;
  lattice.h_over_dx = h_over_dx;
  lattice.support = K::support;
  lattice.jitter = 0.2;
  LatticeBody body(Comm(), lattice, add_velocity);
  ParticleSet& p = body.particles;
  set_velocity(p, [](const Vec3& x) { return Vec3{x.x * x.x, 0, 0}; });
  const auto result = swept_gradient<Cartesian3, K, true>(p, body.pairs, h_over_dx * lattice.spacing);
  double sum = 0, largest = 0;
  for (std::size_t i = 0; i < p.owned(); ++i) {
    const double exact = 2 * p.component(field::position, 0)[i];
    double square = 0;
    for (int b = 0; b < 3; ++b) square += std::pow(result.gradient[i](0, b) - (b == 0 ? exact : 0), 2);
    sum += square;
    largest = std::max(largest, std::sqrt(square));
  }
  return {std::sqrt(Comm().sum(sum) / (double(n) * n * n)) / 2, Comm().max(largest) / 2};
}

TEST(CorrectedGradient, IsFirstOrderOnAQuadraticField) {
  // Catalogue A3: spacing halved three times, order 0.9 at least.
  constexpr int levels = 4;
  std::array<std::array<double, 2>, levels> error;
  for (int k = 0; k < levels; ++k) error[k] = quadratic_error<CubicSpline>(6 << k, 1.3);
  for (int k = 0; k < levels; ++k) std::printf("dx 1/%d: rms %.3e, largest %.3e\n", 6 << k, error[k][0], error[k][1]);
  const double rms = std::log2(error[0][0] / error[levels - 1][0]) / (levels - 1),
               largest = std::log2(error[0][1] / error[levels - 1][1]) / (levels - 1);
  std::printf("order %.2f (rms), %.2f (largest)\n", rms, largest);
  EXPECT_GT(rms, 0.9);
  // The rms falls faster (1.47) because most of it comes from the particles at the faces.
  EXPECT_GT(largest, 0.9);
  EXPECT_LT(error[levels - 1][0], 4.5e-3);  // measured 3.0e-3
}

/// A few particles at given places; volume 1, h 1.3.
template <class S>
struct Few {
  explicit Few(const std::vector<Vec3>& places) : particles(layout_of<S>()) {
    for (const FieldInfo* info : {&field::id, &field::position, &field::velocity, &field::volume}) particles.add(*info);
    particles.resize_owned(places.size());
    for (std::size_t i = 0; i < places.size(); ++i) {
      particles[field::id][i] = static_cast<double>(i);
      particles[field::volume][i] = 1;
      for (int d = 0; d < S::dim; ++d) particles.component(field::position, d)[i] = places[i][d];
    }
    set_velocity(particles, linear);
    pairs.build(particles, 2.6);
  }
  ParticleSet particles;
  PairList pairs;
};

/// Finite, no larger than a few times the true gradient, every particle counted once, correction left at identity.
template <class S>
void stays_plain(const char* name, const std::vector<Vec3>& places) {
  SCOPED_TRACE(name);
  const Few<S> few(places);
  const auto result =
      swept_gradient<S, CubicSpline, true, DensityDiffusion::Off, false, true>(few.particles, few.pairs, 1.3);
  const auto plain = swept_gradient<S, CubicSpline, false>(few.particles, few.pairs, 1.3);
  EXPECT_EQ(result.fallbacks, static_cast<long>(places.size()));
  for (std::size_t i = 0; i < places.size(); ++i)
    for (int a = 0; a < S::dim; ++a)
      for (int b = 0; b < S::dim; ++b) {
        EXPECT_TRUE(std::isfinite(result.gradient[i](a, b)));
        EXPECT_LT(std::abs(result.gradient[i](a, b)), 10);
        EXPECT_NEAR(result.gradient[i](a, b), plain.gradient[i](a, b), 1e-15);  // products fused or not
        EXPECT_EQ(result.correction[i](a, b), a == b ? 1.0 : 0.0);
      }
}

/// A zigzag of particles, nearly a line: the larger its correction, the stiffer it would be, so the correction ends at
/// the bound, keeping its direction; below the bound it is the inverse moment.
TEST(CorrectedGradient, FullCorrectionEndsAtItsBound) {
  if (Comm().size() > 1) GTEST_SKIP() << "particles without a decomposition";
  using S = PlaneStrain;
  constexpr double bound = 50;
  int bounded = 0, whole = 0;
  for (const double amplitude : {0.08, 0.09, 0.1, 0.12, 0.15}) {
    std::vector<Vec3> places;
    for (int i = 0; i < 9; ++i) places.push_back({0.7 * i, i % 2 ? amplitude : -amplitude, 0});
    const Few<S> few(places);
    const auto result =
        swept_gradient<S, CubicSpline, true, DensityDiffusion::Off, false, true>(few.particles, few.pairs, 1.3, bound);
    EXPECT_EQ(result.fallbacks, 0);
    for (std::size_t i = 0; i < places.size(); ++i) {
      Matrix<2> moment;
      for (const Vec3& other : places) {
        const Vec3 d = places[i] - other, g = testing::kernel_gradient<CubicSpline>(d, 1.3, 2);
        for (int a = 0; a < 2; ++a)
          for (int b = 0; b < 2; ++b) moment(a, b) -= d[a] * g[b];
      }
      const Matrix<2> exact = inverse(moment);
      double size = 0;
      for (const double value : exact.a) size += value * value;
      const double share = std::min(1.0, bound / std::sqrt(size));
      (share < 1 ? bounded : whole) += 1;
      for (int c = 0; c < 4; ++c) EXPECT_NEAR(result.correction[i].a[c], share * exact.a[c], 1e-10);
    }
  }
  EXPECT_GT(bounded, 5);
  EXPECT_GT(whole, 5);
}

std::vector<Vec3> row_of(int n, const Vec3& step, int m = 1, const Vec3& other = {}) {
  std::vector<Vec3> places;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < m; ++j) places.push_back(Vec3{0.3, -0.2, 5} + step * i + other * j);
  return places;
}

TEST(CorrectedGradient, PoorNeighbourhoodsStayPlain) {
  if (Comm().size() > 1) GTEST_SKIP() << "particles without a decomposition";
  const Vec3 along{1, 0, 0}, oblique = normalised(Vec3{1, 0.7, -0.4}), across = normalised(cross(oblique, along));
  stays_plain<Cartesian3>("lone", row_of(1, along));
  stays_plain<Cartesian3>("pair", row_of(2, oblique));
  stays_plain<Cartesian3>("line", row_of(11, along));
  stays_plain<Cartesian3>("oblique line", row_of(11, oblique));
  stays_plain<Cartesian3>("plane", row_of(7, {1, 0, 0}, 7, {0, 1, 0}));
  stays_plain<Cartesian3>("oblique plane", row_of(7, oblique, 7, across));
  stays_plain<Cartesian3>("coincident", {{1, 1, 1}, {1, 1, 1}, {1, 1, 1}});
  stays_plain<Cartesian3>("two far apart", {{0, 0, 0}, {100, 0, 0}});
  stays_plain<PlaneStrain>("lone", row_of(1, along));
  stays_plain<PlaneStrain>("pair", row_of(2, normalised(Vec3{1, 0.7, 0})));
  stays_plain<PlaneStrain>("line", row_of(11, normalised(Vec3{1, 0.7, 0})));
}

TEST(CorrectedGradient, OneRemoteParticleIsCountedOnce) {
  if (Comm().size() > 1) GTEST_SKIP() << "particles without a decomposition";
  // A block with its correction and one particle torn off.
  std::vector<Vec3> places{{50, 50, 50}};
  for (int i = 0; i < 125; ++i) places.push_back(Vec3{double(i % 5), double(i / 5 % 5), double(i / 25)});
  const Few<Cartesian3> few(places);
  EXPECT_EQ((swept_gradient<Cartesian3, CubicSpline, true>(few.particles, few.pairs, 1.3).fallbacks), 1);
}

}  // namespace
}  // namespace stirsph
