/// Material state after the velocity gradient is known: volume, stress, plastic strain, heat, and the work done.
#include <algorithm>
#include <array>
#include <cmath>

#include "mechanics/artificial_stress.hpp"
#include "mechanics/mechanics_in.hpp"
#include "mechanics/stress_point.hpp"

namespace stirsph {
namespace {

Lanes load(const double* from) { return Lanes(from, stdx::element_aligned); }

Lanes lane_numbers() {
  return Lanes([](auto lane) { return static_cast<double>(static_cast<std::size_t>(lane)); });
}

double sum_of(const Lanes& values) {
  double sum = 0;
  for (std::size_t lane = 0; lane < lanes; ++lane) sum += values[lane];
  return sum;
}

/// The fields of the material update, as plain pointers.
template <class S>
struct MaterialFields {
  explicit MaterialFields(ParticleSet& particles)
      : strain(particles[field::volumetric_strain].data()),
        volume(particles[field::volume].data()),
        plastic_strain(particles[field::equivalent_plastic_strain].data()),
        plastic_rate(particles[field::plastic_strain_rate].data()),
        flow_stress(particles[field::flow_stress].data()),
        temperature(particles[field::temperature].data()),
        smoothing(particles[field::smoothing_length].data()),
        mass(particles[field::mass].data()),
        material(particles[field::material].data()) {
    if (particles.has(field::rate_factor)) rate_factor = particles[field::rate_factor].data();
    const auto all = [&](const FieldInfo& info, auto& pointers) {
      for (std::size_t c = 0; c < pointers.size(); ++c)
        pointers[c] = particles.component(info, static_cast<int>(c)).data();
    };
    all(field::stress_deviator, deviator);
    all(field::stress, stress);
    if (particles.has(field::artificial_stress)) all(field::artificial_stress, extra);
    if (particles.has(field::corrected_stress)) all(field::corrected_stress, corrected);
    if (particles.has(field::velocity_gradient)) all(field::velocity_gradient, velocity_gradient);
    if (particles.has(field::volumetric_strain_gradient)) all(field::volumetric_strain_gradient, strain_gradient);
    if (particles.has(field::strain_rate)) all(field::strain_rate, strain_rate);
    if (particles.has(field::inverse_moment)) all(field::inverse_moment, inverse_moment);
    if (particles.has(field::heat_input)) heat_input = particles[field::heat_input].data();
    all(field::position, position);
    all(field::velocity, velocity);
  }
  std::array<double*, S::stress_components> deviator, stress, extra{}, strain_rate{};
  std::array<double*, S::velocity_components * S::dim> corrected{}, velocity_gradient{}, inverse_moment{};
  std::array<double*, S::dim> strain_gradient{};
  std::array<const double*, S::dim> position;
  std::array<const double*, S::velocity_components> velocity;
  double *strain, *volume, *plastic_strain, *plastic_rate, *flow_stress;
  const double* temperature;
  double* smoothing;
  const double *mass, *material, *rate_factor = nullptr;
  double* heat_input = nullptr;
};

/// Velocity gradient as a matrix, with respect to the middle of the step, from the sums of the sweep at its end.
/// Axisymmetric: in the frame r theta z that goes round with the ring, so that a common rotation is none, from the
/// gradients of v_r, omega and v_z. Three dimensions without inertia of the swirl: particles have moved along circles,
/// and only what is left of the gradient without their spin tells how the middle of the step differs from its end.
template <class S>
LaneMatrix<Lanes, S::tensor_dim> midstep_gradient(const typename GradientBlock<S>::Gradient& sums, std::size_t at,
                                                  const MaterialFields<S>& f, std::size_t i, const Inertia& inertia,
                                                  double dt) {
  constexpr int dim = S::dim;
  LaneMatrix<Lanes, S::tensor_dim> gradient;
  if constexpr (across < S >> 0) {
    for (auto& row : gradient.a)
      for (Lanes& value : row) value = 0.0;
    const Lanes radius = max(load(f.position[0] + i), Lanes(inertia.core));
    for (int a = 0; a < S::velocity_components; ++a)
      for (int b = 0; b < dim; ++b)
        gradient.a[a][S::axes[b]] = load(&sums[a * dim + b][at]) * (a == 1 ? radius : Lanes(1.0));
    gradient.a[1][1] = load(f.velocity[0] + i) / radius;
    return to_midstep(gradient, dt);
  } else {
    for (int a = 0; a < dim; ++a)
      for (int b = 0; b < dim; ++b) gradient.a[a][b] = load(&sums[a * dim + b][at]);
    if constexpr (dim == 3)
      if (!inertia.swirl) {
        const Lanes x = load(f.position[0] + i), y = load(f.position[1] + i);
        const Lanes spin = (x * load(f.velocity[1] + i) - y * load(f.velocity[0] + i)) /
                           max(Lanes(x * x + y * y), Lanes(inertia.core * inertia.core));
        gradient.a[0][1] += spin;
        gradient.a[1][0] -= spin;
        gradient = to_midstep(gradient, dt);
        gradient.a[0][1] -= spin;
        gradient.a[1][0] += spin;
        return gradient;
      }
    return to_midstep(gradient, dt);
  }
}

/// Work per volume [J/m3] of a step's deformation on the mean of the old and the new stress.
template <class S>
Lanes stress_work(const LaneMatrix<Lanes, S::tensor_dim>& gradient, const Lanes (&before)[S::stress_components],
                  const Lanes (&after)[S::stress_components], double dt) {
  Lanes work = 0.0;
  for (int i = 0; i < S::tensor_dim; ++i)
    for (int j = 0; j < S::tensor_dim; ++j) {
      const int c = symmetric_index(std::min(i, j), std::max(i, j));
      work += (before[c] + after[c]) * gradient.a[i][j];
    }
  return 0.5 * dt * work;
}

/// The return map of up to a cluster of particles. Returns its iterations.
template <class S>
long return_map(const std::vector<Material>& materials, const MaterialFields<S>& f, std::size_t i0, std::size_t count,
                const double* trial, double dt, double* increment) {
  long iterations = 0;
  for (std::size_t k = 0; k < count;) {  // runs of equal material; nearly always one
    const double id = f.material[i0 + k];
    std::size_t end = k + 1;
    while (end < count && f.material[i0 + end] == id) ++end;
    if (const Material& m = materials[static_cast<std::size_t>(id)]; m.flow)
      iterations +=
          m.flow->return_map({static_cast<int>(end - k), trial + k, f.plastic_strain + i0 + k, f.temperature + i0 + k,
                              dt, m.shear_modulus(), increment + k, f.flow_stress + i0 + k, f.plastic_rate + i0 + k,
                              f.rate_factor ? f.rate_factor + i0 + k : nullptr});
    k = end;
  }
  return iterations;
}

/// Takes the swirl around the z axis out of the strain rate of particle i, `at` in the block: of w = v - omega e_z x r
/// with the spin omega of each particle, D_w = D - sym((e_z x r) (x) grad omega).
template <class S>
void without_swirl(const MaterialFields<S>& f, const typename GradientBlock<S>::Gradient& gradient, std::size_t i,
                   std::size_t at, const Inertia& inertia) {
  const double x = f.position[0][i], y = f.position[1][i], vx = f.velocity[0][i], vy = f.velocity[1][i];
  const double square = x * x + y * y, core = inertia.core * inertia.core, reach = std::max(square, core);
  const double moment = x * vy - y * vx;
  std::array<double, 3> slope;  // grad omega
  for (std::size_t b = 0; b < 3; ++b) slope[b] = (x * gradient[3 + b][at] - y * gradient[b][at]) / reach;
  slope[0] += vy / reach;
  slope[1] -= vx / reach;
  if (square > core) {
    slope[0] -= 2 * moment * x / (reach * reach);
    slope[1] -= 2 * moment * y / (reach * reach);
  }
  const std::array<double, 3> turn{-y, x, 0};
  for (int a = 0; a < 3; ++a)
    for (int b = a; b < 3; ++b)
      f.strain_rate[symmetric_index(a, b)][i] -= 0.5 * (turn[a] * slope[b] + turn[b] * slope[a]);
}

}  // namespace

/// A cluster at a time: trial stress in lanes, the return map particle by particle, the rest in lanes again.
template <class S>
void MechanicsIn<S>::update_block(ParticleSet& particles, const GradientBlock<S>& block, std::size_t first, double dt) {
  constexpr int dim = S::dim, components = S::stress_components;
  const MaterialFields<S> f(particles);
  const bool artificial = settings_.artificial_stress > 0, diffusive = settings_.density_diffusion > 0,
             full = settings_.gradient_correction == GradientCorrection::Full,
             unmatched = settings_.gradient_correction == GradientCorrection::Velocity;
  const double diffusion_scale = 2 * settings_.density_diffusion * smoothing_length() * pressure_wave_speed() * dt;
  Lanes plastic_work = 0.0, elastic_work = 0.0, diffusion_work = 0.0, unmatched_work = 0.0, plastic_heat = 0.0;

  const std::size_t last = std::min(first + GradientBlock<S>::size, particles.owned());
  const auto constant = [&](double MaterialConstants::*value, std::size_t at) {
    if (constants_.size() == 1) return Lanes(constants_[0].*value);
    return Lanes([&](auto lane) {
      return constants_[static_cast<std::size_t>(f.material[std::min(at + lane, last - 1)])].*value;
    });
  };
  for (std::size_t i0 = first; i0 < last; i0 += cluster_size) {
    const std::size_t count = std::min(cluster_size, last - i0);
    constexpr std::size_t parts = cluster_size / lanes;
    alignas(64) std::array<double, cluster_size> trial, increment{};
    Lanes s[parts][components], turned[parts][components], rate[parts][components], dilatation[parts], old_work[parts],
        trial_work[parts];
    Lanes old_stress[parts][components];
    for (std::size_t p = 0; p < parts; ++p) {
      const std::size_t at = i0 + p * lanes;
      const auto step = step_deformation<S>(midstep_gradient<S>(block.gradient, at - first, f, at, inertia_, dt), dt);
      for (int c = 0; c < components; ++c) old_stress[p][c] = s[p][c] = load(f.deviator[c] + at);
      const TrialWork<Lanes> work =
          elastic_trial<S>(s[p], turned[p], step, constant(&MaterialConstants::shear, at), dt);
      old_work[p] = work.old_stress;
      trial_work[p] = work.trial_stress;
      equivalent_stress<S>(s[p]).copy_to(&trial[p * lanes], stdx::element_aligned);
      dilatation[p] = step.dilatation;
      for (int c = 0; c < components; ++c) rate[p][c] = step.rate[c];
    }

    counters_.return_map_iterations += return_map(materials_, f, i0, count, trial.data(), dt, increment.data());

    for (std::size_t p = 0; p < parts && p * lanes < count; ++p) {
      const std::size_t at = i0 + p * lanes, filled = std::min(lanes, count - p * lanes);
      const Lanes bulk = constant(&MaterialConstants::bulk, at), flow = load(f.flow_stress + at),
                  plastic_increment = load(&increment[p * lanes]);
      Lanes strain = load(f.strain + at);
      const Lanes old_pressure = -bulk * strain, deformed = dt * dilatation[p];
      const Lanes smoothed = diffusive ? Lanes(diffusion_scale * load(&block.diffusion[at - first])) : Lanes(0.0);
      strain += deformed + smoothed;
      Lanes volume = load(f.mass + at) / constant(&MaterialConstants::density, at) * exponential(strain);
      const Lanes mean = bulk * strain;
      store_lanes(strain, f.strain + at, filled);
      store_lanes(volume, f.volume + at, filled);
      if (f.strain_gradient[0])
        for (int b = 0; b < dim; ++b)
          store_lanes(load(&block.strain_gradient[b][at - first]), f.strain_gradient[b] + at, filled);
      if (settings_.variable_h)
        store_lanes(smoothing_length() * exponential(Lanes(strain * (1.0 / dim))), f.smoothing + at, filled);

      const auto yields = plastic_increment > Lanes(0.0);
      Lanes end_work = trial_work[p];
      if (stdx::any_of(yields)) {
        Lanes returned[components], work = 0.0;
        for (int c = 0; c < components; ++c) returned[c] = s[p][c];
        plastic_return<S>(turned[p], flow, returned);
        for (int c = 0; c < components; ++c) {
          s[p][c] = select(yields, returned[c], s[p][c]);
          work += (c < 3 ? dt : 2 * dt) * s[p][c] * rate[p][c];
        }
        end_work = select(yields, work, end_work);
        counters_.yielding += stdx::popcount(yields);
      }
      Lanes total[components];
      for (int c = 0; c < components; ++c) {
        total[c] = c < 3 ? Lanes(s[p][c] + mean) : s[p][c];
        store_lanes(s[p][c], f.deviator[c] + at, filled);
        store_lanes(total[c], f.stress[c] + at, filled);
      }
      if (artificial) {
        Lanes tensile[components];
        artificial_stress<S>(total, settings_.artificial_stress, tensile);
        for (int c = 0; c < components; ++c) store_lanes(tensile[c], f.extra[c] + at, filled);
      }
      if (keeps_gradient())
        for (int c = 0; c < S::velocity_components * dim; ++c)
          store_lanes(load(&block.gradient[c][at - first]), f.velocity_gradient[c] + at, filled);
      if (reconstructs_viscosity())
        for (int a = 0; a < dim; ++a)
          for (int b = a; b < dim; ++b)
            store_lanes(0.5 * (load(&block.gradient[S::axes[a] * dim + b][at - first]) +
                               load(&block.gradient[S::axes[b] * dim + a][at - first])),
                        f.strain_rate[in_plane_index<S>(a, b)] + at, filled);
      if constexpr (S::dim == 3)
        if (reconstructs_viscosity() && viscosity_has_own_velocity())
          for (std::size_t lane = 0; lane < filled; ++lane)
            without_swirl(f, block.gradient, at + lane, at - first + lane, inertia_);
      if (keeps_gradient())
        for (int a = 0; a < dim; ++a)
          for (int b = 0; b < dim; ++b)
            store_lanes(load(&block.correction[a * dim + b][at - first]), f.inverse_moment[S::axes[a] * dim + b] + at,
                        filled);
      if (full)
        for (int a = 0; a < S::velocity_components; ++a)
          for (int b = 0; b < dim; ++b) {
            Lanes sum = 0.0;
            for (int c = 0; c < dim; ++c)
              sum += total[symmetric_index(std::min(a, S::axes[c]), std::max(a, S::axes[c]))] *
                     load(&block.correction[c * dim + b][at - first]);
            store_lanes(sum, f.corrected[a * dim + b] + at, filled);
          }

      // Work per volume: strain times the mean of old and new stress; what is not plastic is stored. Where the momentum
      // sum is not the adjoint of the gradient, the forces take another work out of the motion than this strain: what
      // they take and the metal does not store is what plastic flow has turned into heat.
      stdx::where(lane_numbers() >= Lanes(static_cast<double>(filled)), volume) = 0.0;
      const Lanes deviatoric_work = 0.5 * (old_work[p] + end_work);
      const Lanes pressure_work = -0.5 * (old_pressure - mean) * deformed;
      Lanes plastic = select(yields, Lanes(plastic_increment * flow), Lanes(0.0));
      const Lanes stored = deviatoric_work + pressure_work - plastic;
      if (unmatched) {
        for (int c = 0; c < 3; ++c) old_stress[p][c] -= old_pressure;
        const Lanes taken =
            stress_work<S>(midstep_gradient<S>(block.plain, at - first, f, at, inertia_, dt), old_stress[p], total, dt);
        plastic = select(yields, Lanes(taken - stored), Lanes(0.0));
        unmatched_work += (taken - stored - plastic) * volume;
      }
      const Lanes heat = constant(&MaterialConstants::taylor_quinney, at) * plastic * volume;
      plastic_work += plastic * volume;
      elastic_work += stored * volume;
      diffusion_work += 0.5 * (old_pressure - mean) * smoothed * volume;
      plastic_heat += heat;
      store_lanes(load(f.plastic_strain + at) + plastic_increment, f.plastic_strain + at, filled);
      store_lanes(plastic_increment * (1 / dt), f.plastic_rate + at, filled);
      if (f.heat_input) store_lanes(load(f.heat_input + at) + heat, f.heat_input + at, filled);
    }
  }
  ledger_.plastic += sum_of(plastic_work);
  ledger_.elastic += sum_of(elastic_work);
  ledger_.diffusion += sum_of(diffusion_work);
  ledger_.unmatched += sum_of(unmatched_work);
  ledger_.plastic_heat += sum_of(plastic_heat);
}

template void MechanicsIn<Cartesian3>::update_block(ParticleSet&, const GradientBlock<Cartesian3>&, std::size_t,
                                                    double);
template void MechanicsIn<PlaneStrain>::update_block(ParticleSet&, const GradientBlock<PlaneStrain>&, std::size_t,
                                                     double);
template void MechanicsIn<AxisymmetricSwirl>::update_block(ParticleSet&, const GradientBlock<AxisymmetricSwirl>&,
                                                           std::size_t, double);

}  // namespace stirsph
