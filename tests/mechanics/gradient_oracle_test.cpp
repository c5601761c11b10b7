/// The SIMD gradient sweep against a plain double sum, for every kernel, space and option.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <tuple>

#include "mechanics/sweep_fixture.hpp"

namespace stirsph {
namespace {

using testing::disordered_body;
using testing::GradientResult;
using testing::kernel_gradient;
using testing::swept_gradient;

/// The sums of pair_sweep.hpp, written down once more.
template <class S, class K>
GradientResult<S> plain_sums(const ParticleSet& p, double smoothing, bool corrected, DensityDiffusion diffusing,
                             bool variable_h) {
  constexpr int dim = S::dim;
  GradientResult<S> result;
  for (std::size_t i = 0; i < p.owned(); ++i) {
    const Vec3 xi = p.vector_at(field::position, i), vi = p.vector_at(field::velocity, i);
    Matrix<dim> gradient, moment;
    double diffusion = 0;
    Vec3 slope;
    const auto strain = p[field::volumetric_strain];
    for (std::size_t j = 0; j < p.total(); ++j) {
      const Vec3 d = xi - p.vector_at(field::position, j), dv = p.vector_at(field::velocity, j) - vi;
      const double h = variable_h ? 0.5 * (p[field::smoothing_length][i] + p[field::smoothing_length][j]) : smoothing;
      const double volume = p[field::volume][j];
      const Vec3 g = kernel_gradient<K>(d, h, dim);
      for (int a = 0; a < dim; ++a)
        for (int b = 0; b < dim; ++b) {
          gradient(a, b) += volume * dv[a] * g[b];
          moment(a, b) -= volume * d[a] * g[b];
        }
      for (int b = 0; b < dim; ++b) slope[b] += volume * (strain[j] - strain[i]) * g[b];
      const Vec3 mean =
          0.5 * (p.vector_at(field::volumetric_strain_gradient, i) + p.vector_at(field::volumetric_strain_gradient, j));
      if (j != i)
        diffusion += volume *
                     (strain[i] - strain[j] - (diffusing == DensityDiffusion::Reconstructed ? dot(mean, d) : 0.0)) *
                     kernel_slope<K>(norm(d), h, dim) / norm(d);
    }
    result.correction.push_back(inverse(moment));
    result.gradient.push_back(corrected ? gradient * result.correction.back() : gradient);
    result.diffusion.push_back(diffusion);
    Vec3& exact = result.strain_gradient.emplace_back(slope);
    if (corrected)
      for (int b = 0; b < dim; ++b) {
        exact[b] = 0;
        for (int a = 0; a < dim; ++a) exact[b] += slope[a] * result.correction.back()(a, b);
      }
  }
  return result;
}

template <int N>
void track(const Matrix<N>& a, const Matrix<N>& b, double& difference, double& size) {
  for (int c = 0; c < N * N; ++c) {
    difference = std::max(difference, std::abs(a.a[c] - b.a[c]));
    size = std::max(size, std::abs(b.a[c]));
  }
}

template <class SpaceAndKernel>
class GradientOracle : public ::testing::Test {
 public:
  using TheSpace = std::tuple_element_t<0, SpaceAndKernel>;
  using TheKernel = std::tuple_element_t<1, SpaceAndKernel>;

  template <bool Corrected, DensityDiffusion Diffusion, bool VariableH, bool Keep>
  double compare(const ParticleSet& p, const PairList& pairs, double smoothing) {
    using S = TheSpace;
    using K = TheKernel;
    const auto swept = swept_gradient<S, K, Corrected, Diffusion, VariableH, Keep>(p, pairs, smoothing);
    const auto plain = plain_sums<S, K>(p, smoothing, Corrected, Diffusion, VariableH);
    EXPECT_EQ(swept.fallbacks, 0);
    double difference = 0, size = 0, kept = 0, kept_size = 1, diffused = 0, diffused_size = 1e-300, sloped = 0,
           slope_size = 1e-300;
    for (std::size_t i = 0; i < p.owned(); ++i) {
      track(swept.gradient[i], plain.gradient[i], difference, size);
      if (Keep) track(swept.correction[i], plain.correction[i], kept, kept_size);
      if (Diffusion != DensityDiffusion::Off) {
        diffused = std::max(diffused, std::abs(swept.diffusion[i] - plain.diffusion[i]));
        diffused_size = std::max(diffused_size, std::abs(plain.diffusion[i]));
      }
      if (Diffusion == DensityDiffusion::Reconstructed) {
        sloped = std::max(sloped, norm(swept.strain_gradient[i] - plain.strain_gradient[i]));
        slope_size = std::max(slope_size, norm(plain.strain_gradient[i]));
      }
    }
    const double worst = std::max({difference / size, kept / kept_size, diffused / diffused_size, sloped / slope_size});
    // Round-off of sums of a hundred terms, times the condition number of M (about 5 at corners).
    EXPECT_LT(worst, 1e-12) << "corrected " << Corrected << " diffusion " << static_cast<int>(Diffusion)
                            << " variable h " << VariableH << " keep " << Keep;
    return worst;
  }
};

using Cases = ::testing::Types<std::tuple<Cartesian3, CubicSpline>, std::tuple<Cartesian3, WendlandC2>,
                               std::tuple<Cartesian3, WendlandC4>, std::tuple<Cartesian3, QuinticSpline>,
                               std::tuple<PlaneStrain, CubicSpline>, std::tuple<PlaneStrain, WendlandC2>,
                               std::tuple<PlaneStrain, WendlandC4>, std::tuple<PlaneStrain, QuinticSpline>>;
TYPED_TEST_SUITE(GradientOracle, Cases);

TYPED_TEST(GradientOracle, EveryOption) {
  using S = typename TestFixture::TheSpace;
  using K = typename TestFixture::TheKernel;
  const double h_over_dx = K::support == 3 ? 1.0 : 1.4;
  const auto body = disordered_body<S>(S::dim == 3 ? 7 : 15, h_over_dx, K::support);
  const double h = h_over_dx * 0.4e-3;
  const auto& [p, pairs] = std::tie(body.particles, body.pairs);
  double worst = 0;
  const auto run = [&]<DensityDiffusion Diffusion, bool VariableH>() {
    worst = std::max(worst, this->template compare<false, Diffusion, VariableH, false>(p, pairs, h));
    worst = std::max(worst, this->template compare<true, Diffusion, VariableH, false>(p, pairs, h));
    worst = std::max(worst, this->template compare<true, Diffusion, VariableH, true>(p, pairs, h));
  };
  run.template operator()<DensityDiffusion::Off, false>();
  run.template operator()<DensityDiffusion::Off, true>();
  run.template operator()<DensityDiffusion::Plain, false>();
  run.template operator()<DensityDiffusion::Plain, true>();
  run.template operator()<DensityDiffusion::Reconstructed, false>();
  run.template operator()<DensityDiffusion::Reconstructed, true>();
  std::printf("%.*s, %d-D: largest relative difference from the plain sum %.1e\n", int(K::keyword.size()),
              K::keyword.data(), S::dim, worst);
}

/// A pressure that grows along a line, as under a weight or a punch, must not be smeared out, at surfaces neither.
TYPED_TEST(GradientOracle, LinearPressureIsNotDiffused) {
  using S = typename TestFixture::TheSpace;
  using K = typename TestFixture::TheKernel;
  const double h_over_dx = K::support == 3 ? 1.0 : 1.4, spacing = 0.4e-3, slope = 2;
  auto body = disordered_body<S>(S::dim == 3 ? 7 : 15, h_over_dx, K::support);
  ParticleSet& p = body.particles;
  for (std::size_t i = 0; i < p.total(); ++i) {
    p[field::volumetric_strain][i] = slope * p.component(field::position, 1)[i];
    for (int d = 0; d < S::dim; ++d) p.component(field::volumetric_strain_gradient, d)[i] = d == 1 ? slope : 0;
  }
  const auto swept = swept_gradient<S, K, true, DensityDiffusion::Reconstructed>(p, body.pairs, h_over_dx * spacing);
  for (std::size_t i = 0; i < p.owned(); ++i) {
    EXPECT_NEAR(swept.diffusion[i] * spacing / slope, 0, 1e-11);  // plain differences leave 0.5 at a face
    for (int d = 0; d < S::dim; ++d) EXPECT_NEAR(swept.strain_gradient[i][d], d == 1 ? slope : 0, 1e-10 * slope);
  }
}

}  // namespace
}  // namespace stirsph
