/// The momentum sweep through Mechanics against a plain double sum, for every kernel, space and option; what it
/// conserves.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <functional>

#include "mechanics/artificial_stress.hpp"
#include "mechanics/mechanics.hpp"
#include "mechanics/sweep_fixture.hpp"

namespace stirsph {
namespace {

using testing::disordered_body;
using testing::kernel_gradient;
using testing::swept_gradient;
using testing::two_materials;

constexpr double spacing = 0.4e-3;

struct Forces {
  std::vector<Vec3> force;  ///< N
  double dissipation = 0;   ///< W, of this rank
};

/// The sum of pair_sweep.hpp, written down once more.
template <class S, class K>
Forces plain_sum(const ParticleSet& p, const MechanicsSettings& settings) {
  constexpr int dim = S::dim;
  const auto materials = two_materials();
  const auto sigma = [&](const FieldInfo& info, std::size_t i) {
    Matrix<dim> m;
    for (int a = 0; a < dim; ++a)
      for (int b = 0; b < dim; ++b) m(a, b) = p.component(info, symmetric_index(std::min(a, b), std::max(a, b)))[i];
    return m;
  };
  const auto stress_of = [&](std::size_t i) {
    if (settings.gradient_correction != GradientCorrection::Full) return sigma(field::stress, i);
    Matrix<dim> m;
    for (int c = 0; c < dim * dim; ++c) m.a[c] = p.component(field::corrected_stress, c)[i];
    return m;
  };
  const auto density_of = [&](std::size_t i) {
    const Material& m = materials[static_cast<int>(p[field::material][i])];
    return m.density * settings.density_scale * std::exp(-p[field::volumetric_strain][i]);
  };
  const auto speed_of = [&](std::size_t i) {
    const Material& m = materials[static_cast<int>(p[field::material][i])];
    return m.sound_speed() / std::sqrt(settings.density_scale);
  };
  const double h0 = settings.h_over_dx * settings.spacing;
  Forces result;
  for (std::size_t i = 0; i < p.owned(); ++i) {
    Vec3 force;
    const Vec3 xi = p.vector_at(field::position, i), vi = p.vector_at(field::velocity, i);
    for (std::size_t j = 0; j < p.total(); ++j) {
      const Vec3 d = xi - p.vector_at(field::position, j), dv = vi - p.vector_at(field::velocity, j);
      const double h = settings.variable_h ? 0.5 * (p[field::smoothing_length][i] + p[field::smoothing_length][j]) : h0;
      if (j == i || norm(d) > K::support * h) continue;
      const Vec3 g = kernel_gradient<K>(d, h, dim);
      const Matrix<dim> si = stress_of(i), sj = stress_of(j), ri = sigma(field::artificial_stress, i),
                        rj = sigma(field::artificial_stress, j);
      // Gray & Monaghan's factor (W(r)/W(dx))^4, W(dx) with the common h.
      const double f = std::pow(K::value(norm(d) / h) / K::value(settings.spacing / h0), 4);
      // Monaghan's viscosity as a pressure: rho_mean (-alpha c mu + beta mu^2) with mu = h v.d/(d^2 + 0.01 h^2) < 0,
      // twice the mean because the sum of the stresses stands where their mean would.
      double q = 0;
      double approach = dot(dv, d);
      if (settings.viscosity_reconstruction) {
        const Matrix<dim> rate_i = sigma(field::strain_rate, i), rate_j = sigma(field::strain_rate, j);
        double explained_i = 0, explained_j = 0;
        for (int a = 0; a < dim; ++a)
          for (int b = 0; b < dim; ++b) {
            explained_i += d[a] * rate_i(a, b) * d[b];
            explained_j += d[a] * rate_j(a, b) * d[b];
          }
        const double sum = explained_i + explained_j,
                     phi = explained_i * explained_j > 0 ? 4 * explained_i * explained_j / (sum * sum) : 0.0;
        approach = std::clamp(approach - phi * sum / 2, std::min(approach, 0.0), 0.0);
      }
      if (approach < 0) {
        const double mu = h * approach / (dot(d, d) + 0.01 * h * h);
        q = 0.5 * (settings.viscosity_beta * (density_of(i) + density_of(j)) * mu * mu -
                   settings.viscosity_alpha * (density_of(i) * speed_of(i) + density_of(j) * speed_of(j)) * mu);
      }
      const double volumes = p[field::volume][i] * p[field::volume][j];
      for (int a = 0; a < dim; ++a)
        for (int b = 0; b < dim; ++b) {
          double s = si(a, b) + sj(a, b) - (a == b ? q : 0.0);
          if (settings.artificial_stress > 0) s += f * (ri(a, b) + rj(a, b));
          force[a] += volumes * s * g[b];
        }
      result.dissipation += 0.5 * volumes * q * dot(g, dv);
    }
    result.force.push_back(force);
  }
  return result;
}

/// The forces by the code: acceleration times inertial mass.
Forces swept_forces(ParticleSet& p, const PairList& pairs, const Space& space, const MechanicsSettings& settings) {
  const auto mechanics = make_mechanics(space, settings, two_materials());
  constexpr double dt = 1e-8;
  mechanics->update_acceleration(p, pairs, dt);
  Forces result;
  for (std::size_t i = 0; i < p.owned(); ++i)
    result.force.push_back(p.vector_at(field::acceleration, i) * (p[field::mass][i] * settings.density_scale));
  result.dissipation = mechanics->ledger().viscous / dt;
  return result;
}

void for_all_options(const std::function<void(const MechanicsSettings&)>& visit) {
  for (bool variable_h : {false, true})
    for (bool artificial : {false, true})
      for (bool full : {false, true})
        for (auto [alpha, beta, reconstruction] :
             {std::tuple{0.0, 0.0, false}, {1.0, 0.0, false}, {0.0, 2.0, false}, {0.5, 1.5, false}, {0.5, 1.5, true}}) {
          MechanicsSettings settings;
          settings.viscosity_reconstruction = reconstruction;
          settings.spacing = spacing;
          settings.variable_h = variable_h;
          settings.artificial_stress = artificial ? 0.3 : 0;
          settings.gradient_correction = full ? GradientCorrection::Full : GradientCorrection::None;
          settings.viscosity_alpha = alpha;
          settings.viscosity_beta = beta;
          settings.density_scale = alpha == 0.5 ? 100 : 1;
          visit(settings);
        }
}
std::string describe(const MechanicsSettings& s) {
  return std::string(s.variable_h ? "variable h " : "") + (s.artificial_stress > 0 ? "artificial stress " : "") +
         (s.gradient_correction == GradientCorrection::Full ? "full correction " : "") + "alpha " +
         std::to_string(s.viscosity_alpha) + " beta " + std::to_string(s.viscosity_beta) +
         (s.viscosity_reconstruction ? " reconstruction" : "");
}

template <class S, class K>
void compare_with_plain_sum() {
  const double h_over_dx = K::support == 3 ? 1.0 : 1.4;
  auto body = disordered_body<S>(S::dim == 3 ? 6 : 13, h_over_dx, K::support);
  ParticleSet& p = body.particles;
  double worst = 0, unbalanced = 0;
  for_all_options([&](MechanicsSettings settings) {
    settings.kernel = K{};
    settings.h_over_dx = h_over_dx;
    const Forces swept = swept_forces(p, body.pairs, S{}, settings), plain = plain_sum<S, K>(p, settings);
    double difference = 0, size = 0;
    Vec3 total;
    for (std::size_t i = 0; i < p.owned(); ++i) {
      difference = std::max(difference, norm(swept.force[i] - plain.force[i]));
      size = std::max(size, norm(plain.force[i]));
      total += swept.force[i];
    }
    // Round-off of a hundred terms.
    EXPECT_LT(difference, 1e-12 * size) << describe(settings);
    EXPECT_NEAR(swept.dissipation, plain.dissipation, 1e-12 * std::abs(plain.dissipation)) << describe(settings);
    if (settings.viscosity_alpha > 0 || settings.viscosity_beta > 0)
      EXPECT_GT(swept.dissipation, 0) << describe(settings);
    else
      EXPECT_EQ(swept.dissipation, 0);
    worst = std::max(worst, difference / size);
    // Momentum: round-off of some hundred forces.
    std::vector<double> sum{total.x, total.y, total.z};
    Comm().sum_in_place(sum);
    for (double component : sum) {
      EXPECT_LT(std::abs(component), 1e-12 * size) << describe(settings);
      unbalanced = std::max(unbalanced, std::abs(component) / size);
    }
  });
  std::printf("%.*s, %d-D: largest relative difference from the plain sum %.1e, total force %.1e of the largest\n",
              int(K::keyword.size()), K::keyword.data(), S::dim, worst, unbalanced);
}

TEST(MomentumOracle, CubicInSpace) { compare_with_plain_sum<Cartesian3, CubicSpline>(); }
TEST(MomentumOracle, WendlandC2InSpace) { compare_with_plain_sum<Cartesian3, WendlandC2>(); }
TEST(MomentumOracle, WendlandC4InSpace) { compare_with_plain_sum<Cartesian3, WendlandC4>(); }
TEST(MomentumOracle, QuinticInSpace) { compare_with_plain_sum<Cartesian3, QuinticSpline>(); }
TEST(MomentumOracle, CubicInPlane) { compare_with_plain_sum<PlaneStrain, CubicSpline>(); }
TEST(MomentumOracle, WendlandC2InPlane) { compare_with_plain_sum<PlaneStrain, WendlandC2>(); }
TEST(MomentumOracle, WendlandC4InPlane) { compare_with_plain_sum<PlaneStrain, WendlandC4>(); }
TEST(MomentumOracle, QuinticInPlane) { compare_with_plain_sum<PlaneStrain, QuinticSpline>(); }

/// Power of the forces = -(stress power): sum F_i.v_i = -sum V_i sigma_i : L_i, for the plain gradient with the plain
/// sum and for the corrected gradient with the fully corrected sum.
template <class S, bool Full, bool VariableH>
void check_adjointness() {
  auto body = disordered_body<S>(S::dim == 3 ? 8 : 20, 1.3, 2);
  ParticleSet& p = body.particles;
  const auto swept =
      swept_gradient<S, CubicSpline, Full, DensityDiffusion::Off, VariableH, Full>(p, body.pairs, 1.3 * spacing);
  double stress_power = 0, size = 0;
  for (std::size_t i = 0; i < p.owned(); ++i)
    for (int a = 0; a < S::dim; ++a)
      for (int b = 0; b < S::dim; ++b) {
        const auto sigma = [&](int k, int l) {
          return p.component(field::stress, symmetric_index(std::min(k, l), std::max(k, l)))[i];
        };
        const double term = p[field::volume][i] * sigma(a, b) * swept.gradient[i](a, b);
        stress_power += term;
        size += std::abs(term);
        if constexpr (Full) {
          double sum = 0;
          for (int c = 0; c < S::dim; ++c) sum += sigma(a, c) * swept.correction[i](c, b);
          p.component(field::corrected_stress, a * S::dim + b)[i] = sum;
        }
      }
  body.halo.exchange(p, Halo::Stress);
  MechanicsSettings settings;
  settings.spacing = spacing;
  settings.variable_h = VariableH;
  settings.viscosity_alpha = 0;
  settings.gradient_correction = Full ? GradientCorrection::Full : GradientCorrection::None;
  const Forces forces = swept_forces(p, body.pairs, S{}, settings);
  double force_power = 0;
  for (std::size_t i = 0; i < p.owned(); ++i) force_power += dot(forces.force[i], p.vector_at(field::velocity, i));
  const Comm comm;
  const double defect = std::abs(comm.sum(force_power) + comm.sum(stress_power)) / comm.sum(size);
  if (comm.is_root())
    std::printf("%d-D %s%s: force power + stress power = %.1e of the sum of magnitudes\n", S::dim,
                Full ? "full correction" : "plain", VariableH ? ", variable h" : "", defect);
  EXPECT_LT(defect, 1e-12);
}
/// A uniform velocity gradient costs nothing with reconstruction, at surfaces neither: the strain rates of both ends
/// explain it.
TEST(ReconstructedViscosity, LeavesALinearFieldAlone) {
  auto body = disordered_body<Cartesian3>(6, 1.4, 2);
  ParticleSet& p = body.particles;
  for (std::size_t i = 0; i < p.total(); ++i) {
    const Vec3 x = p.vector_at(field::position, i);
    const Vec3 v{-3 * x.x + x.y, 2 * x.y - 5 * x.z, -4 * x.z};
    for (int d = 0; d < 3; ++d) p.component(field::velocity, d)[i] = 1e3 * v[d];
    const double rate[] = {-3, 2, -4, 0.5, 0, -2.5};
    for (int c = 0; c < 6; ++c) p.component(field::strain_rate, c)[i] = 1e3 * rate[c];
  }
  MechanicsSettings settings;
  settings.spacing = spacing;
  settings.h_over_dx = 1.4;
  const double whole = swept_forces(p, body.pairs, Cartesian3{}, settings).dissipation;
  settings.viscosity_reconstruction = true;
  const double rest = swept_forces(p, body.pairs, Cartesian3{}, settings).dissipation;
  EXPECT_GT(whole, 0);
  EXPECT_LT(std::abs(rest), 1e-12 * whole);
}

TEST(Adjointness, PlainInSpace) { check_adjointness<Cartesian3, false, false>(); }
TEST(Adjointness, PlainInPlane) { check_adjointness<PlaneStrain, false, false>(); }
TEST(Adjointness, PlainVariableH) { check_adjointness<Cartesian3, false, true>(); }
TEST(Adjointness, FullInSpace) { check_adjointness<Cartesian3, true, false>(); }
TEST(Adjointness, FullInPlane) { check_adjointness<PlaneStrain, true, true>(); }

/// R = -epsilon sigma in tensile principal directions only.
TEST(ArtificialStress, ActsOnTensilePrincipalStressesOnly) {
  // Principal stresses 3, -2, 5 in axes turned about an oblique line.
  const Vec3 axis = normalised(Vec3{1, 2, -1});
  std::array<Vec3, 3> e{Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}};
  for (Vec3& v : e) v = rotated(v, axis, 0.8);
  const std::array<double, 3> principal{3, -2, 5};
  double stress[6], expected[6], artificial[6];
  for (int i = 0; i < 3; ++i)
    for (int j = i; j < 3; ++j) {
      stress[symmetric_index(i, j)] = expected[symmetric_index(i, j)] = 0;
      for (int k = 0; k < 3; ++k) {
        stress[symmetric_index(i, j)] += principal[k] * e[k][i] * e[k][j];
        expected[symmetric_index(i, j)] -= 0.3 * std::max(principal[k], 0.0) * e[k][i] * e[k][j];
      }
    }
  artificial_stress<Cartesian3>(stress, 0.3, artificial);
  for (int c = 0; c < 6; ++c) EXPECT_NEAR(artificial[c], expected[c], 1e-14);
  const double pressed[6] = {-3, -2, -5, 0.5, -0.5, 0.3};
  artificial_stress<Cartesian3>(pressed, 0.3, artificial);
  for (double value : artificial) EXPECT_EQ(value, 0.0);
  // In the plane the stress across it plays no part: principal stresses 4 +- 5, so only 9 counts.
  const double plane[4] = {4, 4, 100, 5};
  double in_plane[4];
  artificial_stress<PlaneStrain>(plane, 0.3, in_plane);
  EXPECT_NEAR(in_plane[0], -0.3 * 4.5, 1e-14);
  EXPECT_NEAR(in_plane[1], -0.3 * 4.5, 1e-14);
  EXPECT_NEAR(in_plane[3], -0.3 * 4.5, 1e-14);
  EXPECT_EQ(in_plane[2], 0.0);
}

}  // namespace
}  // namespace stirsph
