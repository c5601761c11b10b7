/// Material state after the velocity gradient is known: volume, stress, plastic strain, heat, and the work done.
#include <algorithm>
#include <array>
#include <cmath>

#include "mechanics/artificial_stress.hpp"
#include "mechanics/mechanics_in.hpp"
#include "mechanics/stress_point.hpp"

namespace stirsph {
namespace {

/// Loads eight consecutive values as SIMD registers are wide.
Lanes load(const double* from) { return Lanes(from, stdx::element_aligned); }

}  // namespace

template <class S>
void MechanicsIn<S>::update_block(ParticleSet& particles, const GradientBlock<S>& block, std::size_t first, double dt) {
  constexpr int dim = S::dim, components = S::stress_components;
  const std::size_t owned = particles.owned();
  std::array<double*, components> deviator, stress, extra{};
  const bool artificial = settings_.artificial_stress > 0;
  for (int c = 0; c < components; ++c) {
    deviator[c] = particles.component(field::stress_deviator, c).data();
    stress[c] = particles.component(field::stress, c).data();
    if (artificial) extra[c] = particles.component(field::artificial_stress, c).data();
  }
  const bool full = settings_.gradient_correction == GradientCorrection::Full;
  std::array<double*, dim * dim> corrected{};
  if (full)
    for (int c = 0; c < dim * dim; ++c) corrected[c] = particles.component(field::corrected_stress, c).data();
  double* strain = particles[field::volumetric_strain].data();
  double* volume = particles[field::volume].data();
  double* plastic_strain = particles[field::equivalent_plastic_strain].data();
  double* plastic_rate = particles[field::plastic_strain_rate].data();
  double* flow_stress = particles[field::flow_stress].data();
  const double* temperature = particles[field::temperature].data();
  double* smoothing = particles[field::smoothing_length].data();
  double* heat_input = settings_.heat_input ? particles[field::heat_input].data() : nullptr;
  const double* mass = particles[field::mass].data();
  const double* material_of = particles[field::material].data();

  const std::size_t last = std::min(first + GradientBlock<S>::size, owned);
  for (std::size_t i0 = first; i0 < last; i0 += cluster_size) {
    const std::size_t count = std::min(cluster_size, last - i0);
    alignas(64) std::array<double, cluster_size> shear, bulk, trial, old_work, trial_work, rate;
    alignas(64) double s_trial[components][cluster_size], s_old[components][cluster_size],
        strain_rate[components][cluster_size];
    for (std::size_t k = 0; k < cluster_size; ++k) {
      const Material& m = materials_[static_cast<int>(material_of[std::min(i0 + k, last - 1)])];
      shear[k] = m.shear_modulus();
      bulk[k] = m.bulk_modulus();
    }
    for (std::size_t part = 0; part < cluster_size; part += lanes) {
      LaneMatrix<Lanes, dim> gradient;
      for (int a = 0; a < dim; ++a)
        for (int b = 0; b < dim; ++b) gradient.a[a][b] = load(&block.gradient[a * dim + b][i0 - first + part]);
      const auto step = step_deformation<S>(to_midstep(gradient, dt), dt);
      Lanes s[components], turned[components];
      for (int c = 0; c < components; ++c) s[c] = load(deviator[c] + i0 + part);
      const TrialWork<Lanes> work = elastic_trial<S>(s, turned, step, load(&shear[part]), dt);
      work.old_stress.copy_to(&old_work[part], stdx::element_aligned);
      work.trial_stress.copy_to(&trial_work[part], stdx::element_aligned);
      equivalent_stress<S>(s).copy_to(&trial[part], stdx::element_aligned);
      step.dilatation.copy_to(&rate[part], stdx::element_aligned);
      for (int c = 0; c < components; ++c) {
        s[c].copy_to(&s_trial[c][part], stdx::element_aligned);
        turned[c].copy_to(&s_old[c][part], stdx::element_aligned);
        step.rate[c].copy_to(&strain_rate[c][part], stdx::element_aligned);
      }
    }

    std::array<double, cluster_size> increment{};
    for (std::size_t k = 0; k < count;) {  // runs of equal material; nearly always one
      const int id = static_cast<int>(material_of[i0 + k]);
      std::size_t end = k + 1;
      while (end < count && static_cast<int>(material_of[i0 + end]) == id) ++end;
      const Material& m = materials_[id];
      if (m.flow) {
        const FlowBatch batch{static_cast<int>(end - k),
                              &trial[k],
                              plastic_strain + i0 + k,
                              temperature + i0 + k,
                              dt,
                              shear[k],
                              &increment[k],
                              flow_stress + i0 + k};
        counters_.return_map_iterations += m.flow->return_map(batch);
      }
      k = end;
    }

    const double diffusion_scale = 2 * settings_.density_diffusion * smoothing_length() * wave_speed() * dt;
    for (std::size_t k = 0; k < count; ++k) {
      const std::size_t i = i0 + k;
      const Material& m = materials_[static_cast<int>(material_of[i])];
      const double old_pressure = -bulk[k] * strain[i];
      const double deformed = dt * rate[k];
      const double smoothed = settings_.density_diffusion > 0 ? diffusion_scale * block.diffusion[i - first] : 0.0;
      strain[i] += deformed + smoothed;
      volume[i] = mass[i] / m.density * std::exp(strain[i]);
      const double mean = bulk[k] * strain[i];
      if (settings_.variable_h) smoothing[i] = smoothing_length() * std::exp(strain[i] / dim);

      double s[components], total[components], tensile[components];
      for (int c = 0; c < components; ++c) s[c] = s_trial[c][k];
      double end_work = trial_work[k];
      if (increment[k] > 0) {
        double old[components];
        for (int c = 0; c < components; ++c) old[c] = s_old[c][k];
        plastic_return<S>(old, flow_stress[i], s);
        end_work = 0;
        for (int c = 0; c < components; ++c) end_work += (c < 3 ? dt : 2 * dt) * s[c] * strain_rate[c][k];
      }
      for (int c = 0; c < components; ++c) {
        deviator[c][i] = s[c];
        total[c] = deviator[c][i] + (c < 3 ? mean : 0.0);
        stress[c][i] = total[c];
      }
      if (artificial) {
        artificial_stress<S>(total, settings_.artificial_stress, tensile);
        for (int c = 0; c < components; ++c) extra[c][i] = tensile[c];
      }

      if (full)
        for (int a = 0; a < dim; ++a)
          for (int b = 0; b < dim; ++b) {
            double sum = 0;
            for (int c = 0; c < dim; ++c)
              sum += total[symmetric_index(std::min(a, c), std::max(a, c))] * block.correction[c * dim + b][i - first];
            corrected[a * dim + b][i] = sum;
          }

      // Work per volume: strain times the mean of old and new stress; what is not plastic is stored.
      const double deviatoric_work = 0.5 * (old_work[k] + end_work);
      const double plastic = increment[k] > 0 ? increment[k] * flow_stress[i] : 0.0;
      const double pressure_work = -0.5 * (old_pressure - mean) * deformed;
      ledger_.plastic += plastic * volume[i];
      ledger_.elastic += (deviatoric_work - plastic + pressure_work) * volume[i];
      ledger_.diffusion += 0.5 * (old_pressure - mean) * smoothed * volume[i];
      plastic_strain[i] += increment[k];
      plastic_rate[i] = increment[k] / dt;
      if (increment[k] > 0) {
        counters_.yielding += 1;
        const double heat = m.taylor_quinney * plastic * volume[i];
        ledger_.plastic_heat += heat;
        if (heat_input) heat_input[i] += heat;
      }
    }
  }
}

template void MechanicsIn<Cartesian3>::update_block(ParticleSet&, const GradientBlock<Cartesian3>&, std::size_t,
                                                    double);
template void MechanicsIn<PlaneStrain>::update_block(ParticleSet&, const GradientBlock<PlaneStrain>&, std::size_t,
                                                     double);

}  // namespace stirsph
