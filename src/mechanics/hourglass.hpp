/// Stiffness against motion that the velocity gradient does not see: particles that move against each other within a
/// spacing or two (zero-energy or hourglass modes), which under tension is also how updated-Lagrangian particles pair
/// up and part (the tensile instability).
///
/// A pair's velocity less what the gradients of both ends say, dv_ij = v_j - v_i - (L_i + L_j)/2 (x_j - x_i), is zero
/// for any velocity field up to the second degree, so the control works on what the lattice cannot resolve and vanishes
/// as dx^2 for what it can. It loads springs of the material's shear modulus, with the pair weight of the Laplacian,
///   d s_ij/dt = 2 zeta G_ij V0_i V0_j (-W'/r) dv_ij,  F_i = sum_j s_ij,  eta_i = -1/(2 V_i) sum_j s_ij (x) (x_j -
///   x_i).
/// V0 = m/rho0. F and the stress eta together are the adjoint of dv. Only the sums over j are kept. They turn with the
/// material, and where it yields they are returned with the deviator, by sigma_y/(sigma_y + 3 G d(eps_p)): metal that
/// flows has no memory of its lattice. In elastic metal they forget slowly: with large rotations and strains the
/// springs' energy would drift, and it fed a ring that vibrated (B6).
///
/// The idea, shear stiffness of pairs instead of an artificial stress, is that of the non-hourglass formulation (Zhang,
/// Lourenço, Hu, J. Comput. Phys. 2024). L must be exact for linear fields and the stress act as its adjoint also at a
/// free surface: gradient_correction = "full".
#pragma once

#include <vector>

#include "mechanics/pair_sweep.hpp"

namespace stirsph {

/// The springs forget while a shear wave passes so many spacings: by 1/e. With 20 a rubber ring cracks (B6), without
/// forgetting it gains a half of its energy; 80 and 100 do neither.
inline constexpr double hourglass_memory = 100;

template <class S>
struct HourglassRecord {
  static constexpr int x = 0, v = S::dim, gradient = v + S::dim, volume = gradient + S::dim * S::dim,
                       shear = volume + 1,
                       width = shear + 1;  ///< 2 pi r of a ring, else 1
  static constexpr int size = padded_record(width + 1);
};

/// Adds dF/dt [N/s] and -2 V d(eta)/dt [J/s] of clusters [first, last), by components of a position, without zeta.
template <class S, class K>
void hourglass_sweep(const AlignedVector& records, const PairList& pairs, std::size_t first, std::size_t last,
                     std::size_t owned, double smoothing, double* const* rate, double* const* stress_rate) {
  constexpr int dim = S::dim;
  using Record = HourglassRecord<S>;
  const double sigma = K::normalisation(dim), inverse_h = 1 / smoothing,
               constant = sigma * std::pow(inverse_h, dim + 1);
  for (std::size_t cluster = first; cluster < last; ++cluster)
    for (std::size_t part = 0; part < cluster_size; part += lanes) {
      const std::size_t i0 = cluster * cluster_size + part;
      Lanes xi[dim], vi[dim], gi[dim * dim], volume, shear, width;
      load_rows<S, Record>(records, i0, Record::x, dim, xi);
      load_rows<S, Record>(records, i0, Record::v, dim, vi);
      load_rows<S, Record>(records, i0, Record::gradient, dim * dim, gi);
      load_rows<S, Record>(records, i0, Record::volume, 1, &volume);
      load_rows<S, Record>(records, i0, Record::shear, 1, &shear);
      load_rows<S, Record>(records, i0, Record::width, 1, &width);
      Lanes sum[dim], moment[dim * dim];
      for (int a = 0; a < dim; ++a) sum[a] = 0.0;
      for (Lanes& m : moment) m = 0.0;
      for (const std::int32_t j : pairs.candidates(cluster)) {
        const double* other = records.data() + static_cast<std::size_t>(j) * Record::size;
        Lanes d[dim], r2 = tiny_square;
        for (int a = 0; a < dim; ++a) {
          d[a] = other[Record::x + a] - xi[a];
          r2 += d[a] * d[a];
        }
        const Lanes r = sqrt(r2);
        const Lanes slope = constant * K::slope(r * inverse_h) / r;
        // The harmonic mean of the moduli: a soft metal is not stiffened by a hard neighbour.
        const Lanes both = shear + other[Record::shear];
        const Lanes weight =
            slope * other[Record::volume] * (width + other[Record::width]) * shear * (2 * other[Record::shear]) / both;
        for (int a = 0; a < dim; ++a) {
          Lanes unseen = other[Record::v + a] - vi[a];
          for (int b = 0; b < dim; ++b)
            unseen -= 0.5 * (gi[a * dim + b] + other[Record::gradient + a * dim + b]) * d[b];
          unseen *= -weight;
          sum[a] += unseen;
          for (int b = 0; b < dim; ++b) moment[a * dim + b] += unseen * d[b];
        }
      }
      for (int a = 0; a < dim; ++a) {
        const Lanes total = volume * sum[a];
        for (std::size_t lane = 0; lane < lanes && i0 + lane < owned; ++lane) rate[a][i0 + lane] += total[lane];
        for (int b = 0; b < dim; ++b) {
          const Lanes part_of_stress = volume * moment[a * dim + b];
          for (std::size_t lane = 0; lane < lanes && i0 + lane < owned; ++lane)
            stress_rate[a * dim + b][i0 + lane] += part_of_stress[lane];
        }
      }
    }
}

}  // namespace stirsph
