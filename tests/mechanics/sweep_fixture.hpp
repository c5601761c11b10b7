/// Particles with arbitrary velocity, stress, volume, strain and h for the pair sweeps, and the neighbour records
/// packed by hand.
#pragma once

#include <cmath>
#include <numbers>
#include <random>

#include "materials/material.hpp"
#include "mechanics/pair_sweep.hpp"
#include "support/lattice.hpp"

namespace stirsph::testing {

/// Two elastic materials, so that density and impedance differ between neighbours.
inline std::vector<Material> two_materials() {
  Material light, heavy;
  light.density = 2785, light.youngs_modulus = 72.4e9, light.poisson_ratio = 0.33;
  heavy.density = 8960, heavy.youngs_modulus = 124e9, heavy.poisson_ratio = 0.34;
  return {light, heavy};
}

/// A jittered block whose fields follow from the particle ids, so that halo copies carry the same values.
template <class S>
LatticeBody disordered_body(int count, double h_over_dx, double support, double spacing = 0.4e-3) {
  Lattice lattice;
  lattice.dim = S::dim;
  lattice.count = {count, count + 1, S::dim == 3 ? count - 1 : 1};
  lattice.spacing = spacing;
  lattice.h_over_dx = 1.1 * h_over_dx;  // room in the list for the largest h
  lattice.support = support;
  lattice.density = 2785;
  lattice.jitter = 0.2;
  lattice.axisymmetric = across<S> > 0;
  if (lattice.axisymmetric) lattice.inside = [spacing](const Vec3& x) { return x.x > 4 * spacing; };  // no images
  LatticeBody body(Comm(), lattice, [](ParticleSet& particles) {
    for (const FieldInfo* info :
         {&field::velocity, &field::acceleration, &field::volumetric_strain, &field::stress_deviator, &field::stress,
          &field::equivalent_plastic_strain, &field::plastic_strain_rate, &field::flow_stress, &field::temperature,
          &field::artificial_stress, &field::corrected_stress, &field::strain_rate, &field::volumetric_strain_gradient})
      particles.add(*info);
  });
  ParticleSet& p = body.particles;
  for (std::size_t i = 0; i < p.total(); ++i) {
    double volume = std::pow(spacing, S::dim);
    if constexpr (across < S >> 0) volume *= 2 * std::numbers::pi * p.component(field::position, 0)[i];
    std::mt19937_64 random(static_cast<std::uint64_t>(p[field::id][i]) + 99);
    std::uniform_real_distribution<double> even(-1, 1);
    p[field::volume][i] = volume * (1 + 0.1 * even(random));
    p[field::smoothing_length][i] = h_over_dx * spacing * (1 + 0.09 * even(random));
    p[field::volumetric_strain][i] = 0.05 * even(random);
    p[field::material][i] = static_cast<int>(p[field::id][i]) % 2;
    // As in a run: density is mass over volume and follows from the strain.
    p[field::mass][i] =
        (p[field::material][i] == 0 ? 2785 : 8960) * p[field::volume][i] * std::exp(-p[field::volumetric_strain][i]);
    for (int d = 0; d < S::velocity_components; ++d) p.component(field::velocity, d)[i] = 10 * even(random);
    for (int c = 0; c < S::stress_components; ++c) {
      p.component(field::stress, c)[i] = 1e8 * even(random);
      p.component(field::artificial_stress, c)[i] = 1e7 * even(random);
      p.component(field::strain_rate, c)[i] = 3e4 * even(random);  // as what the velocities' differences amount to
    }
    for (int c = 0; c < S::velocity_components * S::dim; ++c)
      p.component(field::corrected_stress, c)[i] = 1e8 * even(random);
    for (int d = 0; d < S::dim; ++d)
      p.component(field::volumetric_strain_gradient, d)[i] = 0.03 / spacing * even(random);
  }
  return body;
}

template <class S, bool VariableH, DensityDiffusion Diffusion>
AlignedVector gradient_records(const ParticleSet& p) {
  using Record = GradientRecord<S, VariableH, Diffusion>;
  AlignedVector records(p.capacity() * Record::size, 0.0);
  for (std::size_t i = 0; i < p.capacity(); ++i) {
    double* record = records.data() + i * Record::size;
    for (int d = 0; d < S::dim; ++d) {
      record[Record::x + d] = p.component(field::position, d)[i];
      record[Record::v + d] = p.component(field::velocity, d)[i];
    }
    record[Record::volume] = p[field::volume][i];
    if constexpr (Record::diffuses) record[Record::strain] = p[field::volumetric_strain][i];
    if constexpr (Record::reconstructs)
      for (int d = 0; d < S::dim; ++d)
        record[Record::strain_gradient + d] = p.component(field::volumetric_strain_gradient, d)[i];
    if constexpr (VariableH) record[Record::h] = p[field::smoothing_length][i];
  }
  return records;
}

/// What the gradient sweep gave for all owned particles.
template <class S>
struct GradientResult {
  std::vector<Matrix<S::dim>> gradient, correction;
  std::vector<double> diffusion;
  std::vector<Vec3> strain_gradient;
  long fallbacks = 0;
};
template <class S, class K, bool Corrected, DensityDiffusion Diffusion = DensityDiffusion::Off, bool VariableH = false,
          bool Keep = false>
GradientResult<S> swept_gradient(const ParticleSet& p, const PairList& pairs, double smoothing, double largest = 50) {
  constexpr int dim = S::dim;
  const AlignedVector records = gradient_records<S, VariableH, Diffusion>(p);
  GradientResult<S> result;
  GradientBlock<S> block{};
  ActivePairs active;
  active.begin(pairs, p.owned());
  for (std::size_t first = 0; first < p.clusters(); first += GradientBlock<S>::clusters) {
    const std::size_t last = std::min(first + GradientBlock<S>::clusters, p.clusters());
    result.fallbacks += velocity_gradient_sweep<S, K, Corrected, Diffusion, VariableH, Keep>(
        records, pairs, first, last, p.owned(), smoothing, largest, block, active);
    for (std::size_t i = first * cluster_size; i < std::min(last * cluster_size, p.owned()); ++i) {
      Matrix<dim>& gradient = result.gradient.emplace_back();
      Matrix<dim>& correction = result.correction.emplace_back();
      for (int c = 0; c < dim * dim; ++c) {
        gradient.a[c] = block.gradient[c][i - first * cluster_size];
        correction.a[c] = block.correction[c][i - first * cluster_size];
      }
      result.diffusion.push_back(block.diffusion[i - first * cluster_size]);
      Vec3& slope = result.strain_gradient.emplace_back();
      for (int d = 0; d < dim; ++d) slope[d] = block.strain_gradient[d][i - first * cluster_size];
    }
  }
  return result;
}

/// grad_i W(x_i - x_j) as written on paper; zero for a particle and itself.
template <class K>
Vec3 kernel_gradient(const Vec3& d, double h, int dim) {
  const double r = norm(d);
  return r > 0 ? d * (kernel_slope<K>(r, h, dim) / r) : Vec3{};
}

}  // namespace stirsph::testing
