/// The material update of whole clusters in SIMD lanes against the scalar functions, particle by particle: every space
/// and option, flow stress models and elastic particles mixed within a cluster, a partly filled last cluster.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <random>
#include <string>
#include <tuple>
#include <vector>

#include "mechanics/artificial_stress.hpp"
#include "mechanics/mechanics.hpp"
#include "mechanics/stress_point.hpp"
#include "mechanics/sweep_fixture.hpp"

namespace stirsph {
namespace {

using testing::disordered_body;
using testing::GradientResult;
using testing::swept_gradient;

constexpr double spacing = 0.4e-3, dt = 1e-7;

Material material_with(const std::string& flow) {
  return make_material(
      input::parse_text("density = \"2785 kg/m3\"\n[elastic]\nyoungs_modulus = \"72.4 GPa\"\n"
                        "poisson_ratio = 0.33\n" +
                            flow,
                        "test.toml", material_schema()));
}
std::vector<Material> mixed_materials() {
  return {material_with(
              "[flow_stress]\nmodel = \"johnson_cook\"\nA = \"90 MPa\"\nB = \"292 MPa\"\nn = 0.31\nC = 0.025\nm = "
              "1.09\nreference_temperature = \"298 K\"\nmelting_temperature = \"900 K\"\n"),
          material_with(
              "[flow_stress]\nmodel = \"linear_hardening\"\nyield_stress = \"200 MPa\"\nhardening_modulus = \"100 "
              "MPa\"\n"),
          material_with("")};
}

/// A state in the middle of a run: some particles yield, some unload, some are hot.
template <class S>
void set_state(ParticleSet& p) {
  p.add(field::heat_input);
  for (std::size_t i = 0; i < p.total(); ++i) {
    std::mt19937_64 random(static_cast<std::uint64_t>(p[field::id][i]) + 7);
    std::uniform_real_distribution<double> even(-1, 1);
    p[field::material][i] = static_cast<int>(p[field::id][i]) % 3;
    p[field::mass][i] = 2785 * p[field::volume][i] * std::exp(-p[field::volumetric_strain][i]);
    p[field::temperature][i] = 650 + 300 * even(random);
    p[field::equivalent_plastic_strain][i] = p[field::material][i] == 2 ? 0 : std::max(0.0, even(random));
    p[field::plastic_strain_rate][i] = std::max(0.0, 1e4 * even(random));
    double trace = 0;
    for (int c = 0; c < S::stress_components; ++c) {
      p.component(field::stress_deviator, c)[i] = 1e8 * even(random);
      if (c < 3) trace += p.component(field::stress_deviator, c)[i];
    }
    for (int c = 0; c < 3; ++c) p.component(field::stress_deviator, c)[i] -= trace / 3;
  }
}

/// Fields by name and component after the step, and the plastic work.
struct State {
  std::map<std::string, std::vector<double>> fields;
  double plastic_work = 0;
};

/// What stress_update.cpp does, one particle after the other.
template <class S>
State plain_update(const ParticleSet& p, const GradientResult<S>& motion, const GradientResult<S>& uncorrected,
                   const MechanicsSettings& settings, double wave_speed) {
  constexpr int dim = S::dim, components = S::stress_components;
  const auto materials = mixed_materials();
  State state;
  const auto put = [&](const std::string& name, double value) { state.fields[name].push_back(value); };
  for (std::size_t i = 0; i < p.owned(); ++i) {
    const Material& m = materials[static_cast<std::size_t>(p[field::material][i])];
    LaneMatrix<double, dim> gradient;
    for (int a = 0; a < dim; ++a)
      for (int b = 0; b < dim; ++b) gradient.a[a][b] = motion.gradient[i](a, b);
    const auto deformation = step_deformation<S>(to_midstep(gradient, dt), dt);
    double s[components], turned[components];
    for (int c = 0; c < components; ++c) s[c] = p.component(field::stress_deviator, c)[i];
    const TrialWork<double> trial_work = elastic_trial<S>(s, turned, deformation, m.shear_modulus(), dt);
    const double trial = equivalent_stress<S>(s), temperature = p[field::temperature][i],
                 plastic_strain = p[field::equivalent_plastic_strain][i], rate = p[field::plastic_strain_rate][i];
    double increment = 0, strength = p[field::flow_stress][i];
    if (m.flow)
      m.flow->return_map(
          {1, &trial, &plastic_strain, &temperature, dt, m.shear_modulus(), &increment, &strength, &rate});
    if (increment > 0) plastic_return<S>(turned, strength, s);
    double strain = p[field::volumetric_strain][i] + dt * deformation.dilatation;
    if (settings.density_diffusion > 0)
      strain += 2 * settings.density_diffusion * settings.h_over_dx * spacing * wave_speed * dt * motion.diffusion[i];
    const double volume = p[field::mass][i] / m.density * std::exp(strain);
    double total[components], extra[components];
    for (int c = 0; c < components; ++c) total[c] = s[c] + (c < 3 ? m.bulk_modulus() * strain : 0.0);
    double work = increment * strength * volume;
    if (settings.gradient_correction == GradientCorrection::Velocity && increment > 0) {
      // What the forces take, the adjoint of the plain gradient, less what the metal stores.
      const double old_strain = p[field::volumetric_strain][i];
      double end = 0, taken = 0;
      for (int c = 0; c < components; ++c) end += (c < 3 ? dt : 2 * dt) * s[c] * deformation.rate[c];
      const double stored = 0.5 * (trial_work.old_stress + end) +
                            0.5 * m.bulk_modulus() * (old_strain + strain) * dt * deformation.dilatation -
                            increment * strength;
      LaneMatrix<double, dim> plain;
      for (int a = 0; a < dim; ++a)
        for (int b = 0; b < dim; ++b) plain.a[a][b] = uncorrected.gradient[i](a, b);
      plain = to_midstep(plain, dt);
      for (int a = 0; a < dim; ++a)
        for (int b = 0; b < dim; ++b) {
          const int c = symmetric_index(std::min(a, b), std::max(a, b));
          const double before =
              p.component(field::stress_deviator, c)[i] + (a == b ? m.bulk_modulus() * old_strain : 0.0);
          taken += 0.5 * dt * (before + total[c]) * plain.a[a][b];
        }
      work = (taken - stored) * volume;
    }
    artificial_stress<S>(total, settings.artificial_stress, extra);

    for (int c = 0; c < components; ++c) {
      put("stress_deviator " + std::to_string(c), s[c]);
      put("stress " + std::to_string(c), total[c]);
      if (settings.artificial_stress > 0) put("artificial_stress " + std::to_string(c), extra[c]);
    }
    if (settings.gradient_correction == GradientCorrection::Full)
      for (int a = 0; a < dim; ++a)
        for (int b = 0; b < dim; ++b) {
          double sum = 0;
          for (int c = 0; c < dim; ++c)
            sum += total[symmetric_index(std::min(a, c), std::max(a, c))] * motion.correction[i](c, b);
          put("corrected_stress " + std::to_string(a * dim + b), sum);
        }
    put("volumetric_strain 0", strain);
    if (settings.density_reconstruction)
      for (int b = 0; b < dim; ++b)
        put("volumetric_strain_gradient " + std::to_string(b), motion.strain_gradient[i][b]);
    put("volume 0", volume);
    put("equivalent_plastic_strain 0", plastic_strain + increment);
    put("plastic_strain_rate 0", increment / dt);
    put("flow_stress 0", strength);
    put("heat_input 0", m.taylor_quinney * work);
    state.plastic_work += work;
  }
  return state;
}

/// Largest difference of a field of the code from the plain one, over the largest value.
double difference(const ParticleSet& p, const std::string& name, const std::vector<double>& plain) {
  const std::size_t space = name.rfind(' ');
  for (const auto& field : p.fields())
    if (field->info->name == name.substr(0, space)) {
      const AlignedVector& values = field->components[std::stoul(name.substr(space + 1))];
      double largest = 0, size = 0;
      for (std::size_t i = 0; i < p.owned(); ++i) {
        largest = std::max(largest, std::abs(values[i] - plain[i]));
        size = std::max(size, std::abs(plain[i]));
      }
      return size > 0 ? largest / size : largest;
    }
  ADD_FAILURE() << "no field " << name;
  return 1;
}

template <class S>
class MaterialUpdate : public ::testing::Test {
 public:
  template <bool Corrected, DensityDiffusion Diffusion, bool Full>
  void compare() {
    auto body = disordered_body<S>(S::dim == 3 ? 6 : 17, 1.3, 2);
    ParticleSet& p = body.particles;
    set_state<S>(p);
    ASSERT_NE(p.owned() % cluster_size, 0u) << "the last cluster should be partly filled";
    MechanicsSettings settings;
    settings.spacing = spacing;
    if (Full) settings.largest_correction = 50;  // the expected sums have no bound
    settings.gradient_correction = Full        ? GradientCorrection::Full
                                   : Corrected ? GradientCorrection::Velocity
                                               : GradientCorrection::None;
    settings.density_diffusion = Diffusion == DensityDiffusion::Off ? 0 : 0.1;
    settings.density_reconstruction = Diffusion == DensityDiffusion::Reconstructed;
    settings.artificial_stress = 0.3;
    settings.heat_input = true;
    const auto mechanics = make_mechanics(S{}, settings, mixed_materials());
    const auto motion = swept_gradient<S, CubicSpline, Corrected, Diffusion, false, Full>(p, body.pairs, 1.3 * spacing);
    const auto uncorrected = swept_gradient<S, CubicSpline, false>(p, body.pairs, 1.3 * spacing);
    const State plain = plain_update<S>(p, motion, uncorrected, settings, mechanics->wave_speed());
    mechanics->update_stress(p, body.pairs, dt);

    double worst = 0;
    for (const auto& [name, values] : plain.fields) {
      const double off = difference(p, name, values);
      // Round-off of the return map (1e-13 of the stress) and of the vector functions.
      EXPECT_LT(off, 1e-12) << name;
      worst = std::max(worst, off);
    }
    EXPECT_NEAR(mechanics->ledger().plastic, plain.plastic_work, 1e-12 * std::abs(plain.plastic_work));
    const double yielding = static_cast<double>(mechanics->counters().yielding) / static_cast<double>(p.owned());
    EXPECT_GT(yielding, 0.1);
    EXPECT_LT(yielding, 0.9);
    std::printf("%d-D, corrected %d, diffusion %d, full %d: largest relative difference %.1e, %.0f %% yield\n", S::dim,
                Corrected, static_cast<int>(Diffusion), Full, worst, 100 * yielding);
  }
};

using Spaces = ::testing::Types<Cartesian3, PlaneStrain>;
TYPED_TEST_SUITE(MaterialUpdate, Spaces);
TYPED_TEST(MaterialUpdate, Plain) { this->template compare<false, DensityDiffusion::Off, false>(); }
TYPED_TEST(MaterialUpdate, Corrected) { this->template compare<true, DensityDiffusion::Off, false>(); }
TYPED_TEST(MaterialUpdate, Diffusion) { this->template compare<false, DensityDiffusion::Plain, false>(); }
TYPED_TEST(MaterialUpdate, FullWithDiffusion) { this->template compare<true, DensityDiffusion::Plain, true>(); }
TYPED_TEST(MaterialUpdate, FullWithReconstructedDiffusion) {
  this->template compare<true, DensityDiffusion::Reconstructed, true>();
}

}  // namespace
}  // namespace stirsph
