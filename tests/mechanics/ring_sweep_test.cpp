/// The sums of the axisymmetric space through Mechanics against plain double sums over rings in cylindrical
/// coordinates; what they conserve.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>

#include "mechanics/mechanics.hpp"
#include "mechanics/sweep_fixture.hpp"

namespace stirsph {
namespace {

using testing::disordered_body;
using testing::kernel_gradient;
using testing::two_materials;

constexpr double spacing = 0.4e-3, smoothing = 1.3 * spacing, pi = std::numbers::pi;

/// A ring as on paper: r and z, v_r omega v_z, stresses rr tt zz rt rz tz, section.
struct Ring {
  Vec3 at;  ///< (r, z, 0)
  Vec3 v;
  std::array<double, 6> s{}, extra{}, rate{};
  double section = 0, volume = 0, density = 0, sound_speed = 0;

  Ring(const ParticleSet& p, std::size_t i, double density_scale) {
    at = {p.component(field::position, 0)[i], p.component(field::position, 1)[i], 0};
    for (int d = 0; d < 3; ++d) v[d] = p.component(field::velocity, d)[i];
    v.y /= at.x;
    for (int c = 0; c < 6; ++c) {
      s[c] = p.component(field::stress, c)[i];
      extra[c] = p.component(field::artificial_stress, c)[i];
      rate[c] = p.component(field::strain_rate, c)[i];
    }
    volume = p[field::volume][i];
    section = volume / (2 * pi * at.x);
    density = density_scale * p[field::mass][i] / volume;
    sound_speed = two_materials()[static_cast<int>(p[field::material][i])].sound_speed() / std::sqrt(density_scale);
  }
  /// Stress in the direction of v_r, omega or v_z on a face across r (b = 0) or z (b = 1), weighted so that the plain
  /// antisymmetric sum gives the force, or torque, of whole rings.
  double weighted(int a, int b, const std::array<double, 6>& stress) const {
    return 2 * pi * at.x * (a == 1 ? at.x : 1.0) * stress[symmetric_index(std::min(a, 2 * b), std::max(a, 2 * b))];
  }
};

std::vector<Ring> rings(const ParticleSet& p, double density_scale) {
  std::vector<Ring> all;
  for (std::size_t i = 0; i < p.total(); ++i) all.emplace_back(p, i, density_scale);
  return all;
}

/// Force along r, torque, force along z of ring i.
Vec3 plain_force(const std::vector<Ring>& all, std::size_t i, const MechanicsSettings& settings) {
  const Ring& me = all[i];
  Vec3 force;
  for (std::size_t j = 0; j < all.size(); ++j) {
    const Ring& other = all[j];
    const Vec3 d = me.at - other.at, g = kernel_gradient<CubicSpline>(d, smoothing, 2);
    if (j == i || norm(d) > 2 * smoothing) continue;
    const double f = std::pow(CubicSpline::value(norm(d) / smoothing) / CubicSpline::value(spacing / smoothing), 4);
    double approach = (me.v.x - other.v.x) * d.x + (me.v.z - other.v.z) * d.y;
    if (settings.viscosity_reconstruction) {
      const auto explained = [&](const Ring& ring) {
        return ring.rate[0] * d.x * d.x + ring.rate[2] * d.y * d.y + 2 * ring.rate[4] * d.x * d.y;
      };
      const double sum = explained(me) + explained(other), product = explained(me) * explained(other);
      approach = std::clamp(approach - (product > 0 ? 2 * product / sum : 0.0), std::min(approach, 0.0), 0.0);
    }
    double q = 0;  // of the two circumferences in the mean
    if (approach < 0) {
      const double mu = smoothing * approach / (dot(d, d) + 0.01 * smoothing * smoothing);
      q = pi * (me.at.x + other.at.x) * 0.5 *
          (settings.viscosity_beta * (me.density + other.density) * mu * mu -
           settings.viscosity_alpha * (me.density * me.sound_speed + other.density * other.sound_speed) * mu);
    }
    for (int a = 0; a < 3; ++a)
      for (int b = 0; b < 2; ++b) {
        double s = me.weighted(a, b, me.s) + other.weighted(a, b, other.s);
        if (a == 2 * b) s -= q;
        if (a != 1 && settings.artificial_stress > 0)
          s += f * (me.weighted(a, b, me.extra) + other.weighted(a, b, other.extra));
        force[a] += me.section * other.section * s * g[b];
      }
  }
  force.x -= me.volume * me.s[1] / me.at.x;
  return force;
}

/// The forces and torques by the code: acceleration times inertial mass (and radius).
std::vector<Vec3> swept_forces(ParticleSet& p, const PairList& pairs, const MechanicsSettings& settings) {
  const auto mechanics = make_mechanics(AxisymmetricSwirl{}, settings, two_materials());
  mechanics->update_acceleration(p, pairs, 1e-8);
  std::vector<Vec3> forces;
  for (std::size_t i = 0; i < p.owned(); ++i) {
    const double mass = p[field::mass][i] * settings.density_scale;
    forces.push_back({mass * p.component(field::acceleration, 0)[i],
                      mass * settings.swirl_density_ratio * p.component(field::acceleration, 1)[i] *
                          p.component(field::position, 0)[i],
                      mass * p.component(field::acceleration, 2)[i]});
  }
  return forces;
}

TEST(RingOracle, ForcesAreThePlainSum) {
  auto body = disordered_body<AxisymmetricSwirl>(16, 1.3, 2);
  ParticleSet& p = body.particles;
  for (const bool artificial : {false, true})
    for (const auto [alpha, beta, scale, swirl] : {std::array{0.0, 0.0, 1.0, 1.0}, {0.5, 1.5, 100.0, 0.1}}) {
      MechanicsSettings settings;
      settings.spacing = spacing;
      settings.artificial_stress = artificial ? 0.3 : 0;
      settings.viscosity_alpha = alpha;
      settings.viscosity_beta = beta;
      settings.viscosity_reconstruction = artificial;  // each of them is off once
      settings.density_scale = scale;
      settings.swirl_density_ratio = swirl;
      const std::vector<Ring> all = rings(p, scale);
      const std::vector<Vec3> swept = swept_forces(p, body.pairs, settings);
      Vec3 difference, size, total;
      for (std::size_t i = 0; i < p.owned(); ++i) {
        const Vec3 plain = plain_force(all, i, settings);
        for (int a = 0; a < 3; ++a) {
          difference[a] = std::max(difference[a], std::abs(swept[i][a] - plain[a]));
          size[a] = std::max(size[a], std::abs(plain[a]));
        }
        total += swept[i];
      }
      std::vector<double> sums{total.y, total.z};
      Comm().sum_in_place(sums);
      for (int a = 0; a < 3; ++a) EXPECT_LT(difference[a], 1e-12 * size[a]) << "component " << a;
      // Angular momentum and momentum along z; there is none along r.
      EXPECT_LT(std::abs(sums[0]), 1e-12 * size.y);
      EXPECT_LT(std::abs(sums[1]), 1e-12 * size.z);
    }
}

/// Power of forces and torques = -(stress power) with the plain gradients of v_r, omega and v_z and the hoop strain.
TEST(RingOracle, ForcesAreAdjointToTheGradient) {
  auto body = disordered_body<AxisymmetricSwirl>(16, 1.3, 2);
  ParticleSet& p = body.particles;
  MechanicsSettings settings;
  settings.spacing = spacing;
  settings.viscosity_alpha = 0;
  const std::vector<Ring> all = rings(p, 1);
  const std::vector<Vec3> forces = swept_forces(p, body.pairs, settings);
  double force_power = 0, stress_power = 0, size = 0;
  for (std::size_t i = 0; i < p.owned(); ++i) {
    const Ring& me = all[i];
    force_power += dot(forces[i], me.v);
    double power = me.s[1] * me.v.x / me.at.x;
    for (std::size_t j = 0; j < all.size(); ++j) {
      const Ring& other = all[j];
      const Vec3 d = me.at - other.at, g = kernel_gradient<CubicSpline>(d, smoothing, 2), dv = other.v - me.v;
      if (j == i || norm(d) > 2 * smoothing) continue;
      for (int a = 0; a < 3; ++a)
        for (int b = 0; b < 2; ++b)
          power += me.weighted(a, b, me.s) / (2 * pi * me.at.x) * other.section * dv[a] * g[b];
    }
    stress_power += me.volume * power;
    size += std::abs(me.volume * power);
  }
  const Comm comm;
  const double defect = std::abs(comm.sum(force_power) + comm.sum(stress_power)) / comm.sum(size);
  if (comm.is_root()) std::printf("rings: force power + stress power = %.1e of the sum of magnitudes\n", defect);
  EXPECT_LT(defect, 1e-12);
}

}  // namespace
}  // namespace stirsph
