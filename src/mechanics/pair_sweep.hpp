/// The two pair sums of a step, over clusters of 8 particles in SIMD lanes against their candidate neighbours one by
/// one.
///
/// Velocity gradient  L_i = sum_j V_j (v_j - v_i) (x) grad W_ij          [optionally times M_i^-1, M the first moment]
/// Internal force     F_i = V_i sum_j V_j (sigma_i + sigma_j - q_ij I + f^n (R_i + R_j)) . grad W_ij
/// The force is antisymmetric in i and j, so momentum is conserved to round-off, and it is the adjoint of the
/// uncorrected gradient, so the stress power equals the work of the forces. With the full correction sigma M^-1 takes
/// the place of sigma: still antisymmetric, and the adjoint of the corrected gradient. q_ij is Monaghan's viscosity, R
/// the artificial stress of Gray, Monaghan & Swift (2001), f = W(r)/W(dx), n = 4.
///
/// With reconstruction the viscosity sees the approach of a pair less what the strain rates D of both ends explain,
///   (v_i - v_j).d - phi (p_i + p_j)/2,  p = d.D d,  d = x_i - x_j,  phi = max(0, 4 p_i p_j/(p_i + p_j)^2),
/// the limiter of van Leer as in Frontiere, Raskin & Owen (J. Comput. Phys. 332, 2017), held between the whole approach
/// and zero, so that it takes no more out of the motion than without and gives nothing back. A smooth flow is then free
/// of viscosity to the second order; shocks (where the rates of both ends differ) and what single particles do are not.
///
/// The density diffusion smooths the volumetric strain e by the jumps e_i - e_j between particles. With reconstruction
/// it sees what the gradients of e at both ends (those of the last step) leave of a jump, (e_i - e_j) - (g_i +
/// g_j).d/2, as in Antuono, Colagrossi, Marrone & Molteni (Comput. Phys. Commun. 181, 2010): a pressure that varies
/// smoothly stays where it is. Without, metal is pumped out of loaded regions, whose particles then crowd while others
/// drift apart.
///
/// In the axisymmetric space the sums run over the half-plane (kernel of two dimensions, V_j = the ring's section A_j)
/// and over generalised quantities: velocities v_r, omega = v_theta/r, v_z and the stresses 2 pi r sigma_r., 2 pi r^2
/// sigma_theta., 2 pi r sigma_z.. The same antisymmetric sum then gives the force of a whole ring and, for omega, its
/// torque: the adjoint of the gradient of omega (a gradient of v_theta would not be, and feeds energy into the swirl).
/// What is left of the divergence in a cylindrical frame, the hoop stress, is added by the caller.
///
/// Neighbours are packed into one record each, so that a neighbour costs one or two cache lines. Candidates outside the
/// support, the particle itself and padding lanes give exact zeros: there is no branch in the loop.
///
/// The first sweep visits a pair from both sides, the second, whose terms cost more than the sum over lanes that the
/// other side needs, from one side where both particles are this rank's.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <span>
#include <vector>

#include "mechanics/lane_matrix.hpp"
#include "mechanics/settings.hpp"
#include "neighbours/pair_list.hpp"
#include "particles/field_names.hpp"
#include "particles/particle_set.hpp"

namespace stirsph {

static_assert(cluster_size % lanes == 0, "a cluster is a whole number of SIMD registers");

constexpr int padded_record(int size) { return (size + 7) / 8 * 8; }

/// Velocity components across the plane of the positions: the swirl of the axisymmetric space, in the middle of the
/// other two.
template <class S>
inline constexpr int across = S::velocity_components - S::dim;

/// Keeps r away from zero for the particle itself; (1e-30 m)^2, far below any spacing.
inline constexpr double tiny_square = 1e-60;

/// The pairs that the second sweep visits: for each register of particles the candidates that one of them reaches now.
/// The first sweep finds them on its way, at the same positions; what is left out are exact zeros. Of two clusters of
/// this rank the earlier one has the pair and gives the other its share of the force, so only candidates behind the
/// cluster are listed; its own 8 particles always belong to it.
class ActivePairs {
 public:
  /// Before a first sweep over `list`; `owned` particles are this rank's.
  void begin(const PairList& list, std::size_t owned) {
    owned_ = static_cast<std::int32_t>(owned);
    starts_.resize(list.clusters() + 1);
    starts_[0] = 0;
    for (std::size_t c = 0; c < list.clusters(); ++c) starts_[c + 1] = starts_[c] + list.candidates_behind(c).size();
    indices_.resize(starts_.back() * parts + 1);  // one more: where the last candidate is written that is not kept
    counts_.resize(list.clusters() * parts);
    valid_ = false;
  }

  /// Takes the candidates behind the cluster of one register in their order; registers may come in any order.
  class Writer {
   public:
    Writer(ActivePairs& active, std::size_t cluster, std::size_t part)
        : count_(active.counts_[cluster * parts + part]), out_(active.indices_.data() + active.offset(cluster, part)) {
      count_ = 0;
    }
    void take(std::int32_t j, bool reached) {
      out_[count_] = j;
      count_ += reached;
    }

   private:
    std::uint32_t& count_;
    std::int32_t* out_;
  };

  /// Every candidate, where no first sweep has looked.
  void take_all(const PairList& list, std::size_t owned) {
    begin(list, owned);
    for (std::size_t cluster = 0; cluster < list.clusters(); ++cluster)
      for (std::size_t part = 0; part < parts; ++part) {
        Writer writer(*this, cluster, part);
        for (const std::int32_t j : list.candidates_behind(cluster)) writer.take(j, true);
      }
    complete();
  }
  /// All registers are written: the next second sweep may use them.
  void complete() { valid_ = true; }
  /// The positions are about to change.
  void expire() { valid_ = false; }
  bool valid() const { return valid_; }

  struct Partners {
    std::span<const std::int32_t> owned, halo;
  };
  Partners of(std::size_t cluster, std::size_t part) const {
    const std::span<const std::int32_t> all(indices_.data() + offset(cluster, part), counts_[cluster * parts + part]);
    const auto owned = static_cast<std::size_t>(std::lower_bound(all.begin(), all.end(), owned_) - all.begin());
    return {all.first(owned), all.subspan(owned)};
  }
  std::size_t bytes() const {
    return indices_.capacity() * sizeof(std::int32_t) + counts_.capacity() * sizeof(std::uint32_t) +
           starts_.capacity() * sizeof(std::size_t);
  }

 private:
  static constexpr std::size_t parts = cluster_size / lanes;
  std::size_t offset(std::size_t cluster, std::size_t part) const {
    return starts_[cluster] * parts + part * (starts_[cluster + 1] - starts_[cluster]);
  }
  std::vector<std::int32_t> indices_;
  std::vector<std::size_t> starts_;    ///< per cluster, of one register's place
  std::vector<std::uint32_t> counts_;  ///< per register
  std::int32_t owned_ = 0;
  bool valid_ = false;
};

/// Cluster-wise results of the first sweep for a run of clusters.
template <class S>
struct GradientBlock {
  static constexpr std::size_t clusters = 32;  ///< results of this many clusters stay in the first-level cache
  static constexpr std::size_t size = clusters * cluster_size;
  using Gradient = double[S::velocity_components * S::dim][size];
  alignas(64) Gradient gradient;  ///< d v_a / d x_b at a * dim + b
  alignas(64) Gradient plain;     ///< the same before its correction; set where the momentum sum has none
  alignas(64) double correction[S::dim * S::dim][size];  ///< M^-1, identity where it is singular; set when asked for
  alignas(64) double diffusion[size];  ///< sum of V_j (e_i - e_j) W'/r; W' < 0, so it pulls e_i towards its neighbours
  alignas(64) double strain_gradient[S::dim][size];  ///< d e / d x_b; set where it is needed for the diffusion
};

template <class S, bool VariableH, DensityDiffusion Diffusion>
struct GradientRecord {
  static constexpr bool diffuses = Diffusion != DensityDiffusion::Off,
                        reconstructs = Diffusion == DensityDiffusion::Reconstructed;
  static constexpr int x = 0, v = S::dim, volume = v + S::velocity_components, strain = volume + 1,
                       strain_gradient = strain + (diffuses ? 1 : 0), h = strain_gradient + (reconstructs ? S::dim : 0);
  static constexpr int size = padded_record(h + (VariableH ? 1 : 0));
};

/// The component of a position in the direction of the velocity component c; -1 for one across.
template <class S>
constexpr int plane_index(int c) {
  for (int d = 0; d < S::dim; ++d)
    if (S::axes[d] == c) return d;
  return -1;
}

template <class S, bool VariableH, bool ArtificialStress, bool Full, bool OwnVelocity = false, bool Reconstruct = false>
struct MomentumRecord {
  static constexpr int tensor = S::dim * (S::dim + 1) / 2;  ///< in-space components of a symmetric tensor
  static constexpr int stress_size = Full ? S::velocity_components * S::dim : tensor + across<S> * S::dim;
  static constexpr int x = 0, v = S::dim, volume = v + S::velocity_components, impedance = volume + 1,
                       density = impedance + 1, stress = density + 1, artificial = stress + stress_size,
                       h = artificial + (ArtificialStress ? tensor : 0), own = h + (VariableH ? 1 : 0),
                       rate = own + (OwnVelocity ? S::velocity_components : 0);
  static constexpr int size = padded_record(rate + (Reconstruct ? tensor : 0));
};

/// In-space components (i <= j < dim) of a symmetric tensor, in storage order.
template <class S>
constexpr int tensor_slot(int i, int j) {
  if constexpr (S::dim == 3) return symmetric_index(i, j);
  return i == j ? i : 2;
}

/// Where a record keeps the stress that acts in the direction of velocity component c on a face across direction b.
template <class S, bool Full>
constexpr int stress_slot(int c, int b) {
  if constexpr (Full) return c * S::dim + b;
  const int a = plane_index<S>(c);
  return a < 0 ? S::dim * (S::dim + 1) / 2 + b : tensor_slot<S>(std::min(a, b), std::max(a, b));
}

template <class S, class Record>
void load_rows(const AlignedVector& records, std::size_t first, int offset, int count, Lanes* out) {
  for (int c = 0; c < count; ++c)
    out[c] = Lanes([&](auto lane) { return records[(first + lane) * Record::size + offset + c]; });
}

/// First sweep over clusters [first, last). `smoothing` is h when it is the same for all particles, `largest` the bound
/// of settings.hpp on |M^-1|. Returns how many of the `owned` particles could not be corrected (the last cluster may
/// hold padding behind them).
template <class S, class K, bool Corrected, DensityDiffusion Diffusion, bool VariableH, bool KeepCorrection = false>
long velocity_gradient_sweep(const AlignedVector& records, const PairList& pairs, std::size_t first, std::size_t last,
                             std::size_t owned, double smoothing, double largest, GradientBlock<S>& block,
                             ActivePairs& active) {
  constexpr int dim = S::dim, components = S::velocity_components;
  using Record = GradientRecord<S, VariableH, Diffusion>;
  const double sigma = K::normalisation(dim);
  long fallbacks = 0;
  for (std::size_t cluster = first; cluster < last; ++cluster) {
    for (std::size_t part = 0; part < cluster_size; part += lanes) {
      const std::size_t i0 = cluster * cluster_size + part;
      Lanes xi[dim], vi[components], ei{}, gi[dim], hi{};
      load_rows<S, Record>(records, i0, Record::x, dim, xi);
      load_rows<S, Record>(records, i0, Record::v, components, vi);
      if constexpr (Record::diffuses) load_rows<S, Record>(records, i0, Record::strain, 1, &ei);
      if constexpr (Record::reconstructs) load_rows<S, Record>(records, i0, Record::strain_gradient, dim, gi);
      if constexpr (VariableH) load_rows<S, Record>(records, i0, Record::h, 1, &hi);
      LaneMatrix<Lanes, components, dim> gradient;
      LaneMatrix<Lanes, 1, dim> strain_gradient;
      LaneMatrix<Lanes, dim> moment;
      Lanes diffusion = 0.0;
      for (int b = 0; b < dim; ++b) {
        for (int a = 0; a < components; ++a) gradient.a[a][b] = 0.0;
        strain_gradient.a[0][b] = 0.0;
        for (int a = 0; a < dim; ++a) moment.a[a][b] = 0.0;
      }
      const double inverse_h = 1 / smoothing;
      const double constant = sigma * std::pow(inverse_h, dim + 1);

      // Adds candidate j; returns whether one of the particles reaches it.
      const auto visit = [&](std::int32_t j) __attribute__((always_inline)) {
        const double* other = records.data() + static_cast<std::size_t>(j) * Record::size;
        Lanes d[dim], r2 = tiny_square;
        for (int a = 0; a < dim; ++a) {
          d[a] = xi[a] - other[Record::x + a];
          r2 += d[a] * d[a];
        }
        const Lanes r = sqrt(r2);
        Lanes weight, q;  // V_j W'(r)/r, r/h
        if constexpr (VariableH) {
          const Lanes inverse = 2.0 / (hi + other[Record::h]);
          Lanes power = inverse * inverse * inverse;
          if constexpr (dim == 3) power *= inverse;
          q = r * inverse;
          weight = other[Record::volume] * sigma * power * K::slope(q) / r;
        } else {
          q = r * inverse_h;
          weight = other[Record::volume] * constant * K::slope(q) / r;
        }
        [[maybe_unused]] Lanes jump{}, own = 0.0, others = 0.0;  // of the volumetric strain
        if constexpr (Record::diffuses) jump = ei - other[Record::strain];
        for (int b = 0; b < dim; ++b) {
          const Lanes g = weight * d[b];
          if constexpr (Record::reconstructs) {
            strain_gradient.a[0][b] -= g * jump;
            own += gi[b] * d[b];
            others += other[Record::strain_gradient + b] * d[b];
          }
          for (int a = 0; a < components; ++a) gradient.a[a][b] += g * (other[Record::v + a] - vi[a]);
          if constexpr (Corrected)
            for (int a = 0; a <= b; ++a) moment.a[a][b] -= g * d[a];
        }
        if constexpr (Record::reconstructs) jump -= 0.5 * (own + others);
        if constexpr (Record::diffuses) diffusion += weight * jump;
        return stdx::any_of(q < Lanes(K::support));
      };
      for (const std::int32_t j : pairs.candidates_before_end(cluster)) visit(j);
      ActivePairs::Writer behind(active, cluster, part / lanes);
      for (const std::int32_t j : pairs.candidates_behind(cluster)) behind.take(j, visit(j));

      const std::size_t at = (cluster - first) * cluster_size + part;
      const auto store = [&](typename GradientBlock<S>::Gradient& to) {
        for (int a = 0; a < components; ++a)
          for (int b = 0; b < dim; ++b) gradient.a[a][b].copy_to(&to[a * dim + b][at], stdx::vector_aligned);
      };
      if constexpr (Corrected) {
        if constexpr (!KeepCorrection) store(block.plain);
        for (int b = 0; b < dim; ++b)
          for (int a = b + 1; a < dim; ++a) moment.a[a][b] = moment.a[b][a];
        // L = G M^-1 (M symmetric). A particle with too few or coplanar neighbours keeps the plain sum: its moment is
        // nearly singular (condition number above about 100, or hardly any support at all).
        const LaneMatrix<Lanes, dim> cofactors = adjugate(moment);
        const Lanes det = determinant(moment);
        Lanes norm2 = 0.0, cofactor_norm2 = 0.0, trace = 0.0;
        for (int a = 0; a < dim; ++a) {
          trace += moment.a[a][a];
          for (int b = 0; b < dim; ++b) {
            norm2 += moment.a[a][b] * moment.a[a][b];
            cofactor_norm2 += cofactors.a[a][b] * cofactors.a[a][b];
          }
        }
        // On an oblique line cofactors and determinant are both round-off and their ratio says nothing: hence the bound
        // on the determinant itself, 1e-2 of the least one that the condition number allows.
        Lanes volume = 1e-6 * trace;
        for (int a = 1; a < dim; ++a) volume *= trace;
        auto sound = trace > Lanes(0.05 * dim) && det > volume && norm2 * cofactor_norm2 < 1e4 * det * det;
        // What is above the bound: with the plain momentum sum the plain gradient as well, else the bound itself.
        Lanes share = 1.0;
        if constexpr (KeepCorrection)
          share = min(share, Lanes(largest * det / sqrt(cofactor_norm2)));
        else
          sound = sound && cofactor_norm2 < largest * largest * det * det;
        const Lanes factor = share / det;
        if (stdx::popcount(sound) != static_cast<int>(lanes))
          for (std::size_t lane = 0; lane < lanes; ++lane) fallbacks += !sound[lane] && i0 + lane < owned;
        const LaneMatrix<Lanes, components, dim> corrected = multiply(gradient, cofactors);
        for (int a = 0; a < components; ++a)
          for (int b = 0; b < dim; ++b) stdx::where(sound, gradient.a[a][b]) = corrected.a[a][b] * factor;
        if constexpr (Record::reconstructs) {
          const LaneMatrix<Lanes, 1, dim> exact = multiply(strain_gradient, cofactors);
          for (int b = 0; b < dim; ++b) stdx::where(sound, strain_gradient.a[0][b]) = exact.a[0][b] * factor;
        }
        if constexpr (KeepCorrection)
          for (int a = 0; a < dim; ++a)
            for (int b = 0; b < dim; ++b) {
              Lanes inverse = a == b ? 1.0 : 0.0;
              stdx::where(sound, inverse) = cofactors.a[a][b] * factor;
              inverse.copy_to(&block.correction[a * dim + b][at], stdx::vector_aligned);
            }
      }
      store(block.gradient);
      if constexpr (Record::diffuses) diffusion.copy_to(&block.diffusion[at], stdx::vector_aligned);
      if constexpr (Record::reconstructs)
        for (int b = 0; b < dim; ++b)
          strain_gradient.a[0][b].copy_to(&block.strain_gradient[b][at], stdx::vector_aligned);
    }
  }
  return fallbacks;
}

/// What the second sweep needs besides the records.
struct MomentumConstants {
  double smoothing;    ///< m
  double spacing;      ///< m
  double alpha, beta;  ///< viscosity
};

/// Second sweep over clusters [first, last): adds forces [N] to `force`, all particles of the rank, and sets viscous
/// dissipation and the power taken out by the artificial stress [W] per particle: where a pair is visited once, the
/// earlier particle has the pair's whole power. Halo copies' forces are left to their owners.
/// `OwnVelocity`: the viscosity sees another velocity than the true one (that without the swirl).
/// `Reconstruct`: the viscosity sees what the strain rates of both ends leave of a pair's approach.
template <class S, class K, bool Viscous, bool ArtificialStress, bool VariableH, bool Full, bool OwnVelocity = false,
          bool Reconstruct = false>
void momentum_sweep(const AlignedVector& records, const ActivePairs& active, std::size_t first, std::size_t last,
                    const MomentumConstants& constants, double* const* force, double* dissipation,
                    double* artificial_power) {
  constexpr int dim = S::dim, components = S::velocity_components;
  static_assert(!Reconstruct || Viscous);
  using Record = MomentumRecord<S, VariableH, ArtificialStress, Full, OwnVelocity, Reconstruct>;
  constexpr int tensor = Record::tensor, stress_size = Record::stress_size;
  [[maybe_unused]] constexpr std::array<int, 3> axis = S::axes;
  const double sigma = K::normalisation(dim), inverse_h = 1 / constants.smoothing;
  const double constant = sigma * std::pow(inverse_h, dim + 1);
  const double at_spacing = 1 / K::value(constants.spacing * inverse_h);
  alignas(64) double shares[components][lanes * lanes];  // forces of `lanes` pairs, for the sums over lanes
  alignas(64) double sums[components][lanes];
  for (std::size_t cluster = first; cluster < last; ++cluster) {
    for (std::size_t part = 0; part < cluster_size; part += lanes) {
      const std::size_t i0 = cluster * cluster_size + part;
      Lanes xi[dim], vi[components], wi[components], si[stress_size], ri[tensor], rate[tensor], volume, impedance{},
          density{}, hi{};
      load_rows<S, Record>(records, i0, Record::x, dim, xi);
      load_rows<S, Record>(records, i0, Record::stress, stress_size, si);
      load_rows<S, Record>(records, i0, Record::volume, 1, &volume);
      if constexpr (Viscous || ArtificialStress) load_rows<S, Record>(records, i0, Record::v, components, vi);
      if constexpr (OwnVelocity) load_rows<S, Record>(records, i0, Record::own, components, wi);
      if constexpr (Viscous) {
        load_rows<S, Record>(records, i0, Record::impedance, 1, &impedance);
        load_rows<S, Record>(records, i0, Record::density, 1, &density);
      }
      if constexpr (ArtificialStress) load_rows<S, Record>(records, i0, Record::artificial, tensor, ri);
      if constexpr (Reconstruct) load_rows<S, Record>(records, i0, Record::rate, tensor, rate);
      if constexpr (VariableH) load_rows<S, Record>(records, i0, Record::h, 1, &hi);
      Lanes f[components], dissipated = 0.0, absorbed = 0.0;
      for (int a = 0; a < components; ++a) f[a] = 0.0;

      // Adds the force of j on i to f and returns it in `share`, all but the factor V_i.
      const auto visit = [&](std::int32_t j, Lanes * share) __attribute__((always_inline)) {
        const double* other = records.data() + static_cast<std::size_t>(j) * Record::size;
        Lanes d[dim], r2 = tiny_square;
        for (int a = 0; a < dim; ++a) {
          d[a] = xi[a] - other[Record::x + a];
          r2 += d[a] * d[a];
        }
        const Lanes r = sqrt(r2);
        Lanes h = constants.smoothing, weight, q;
        if constexpr (VariableH) {
          h = 0.5 * (hi + other[Record::h]);
          const Lanes inverse = 1.0 / h;
          Lanes power = inverse * inverse * inverse;
          if constexpr (dim == 3) power *= inverse;
          q = r * inverse;
          weight = other[Record::volume] * sigma * power * K::slope(q) / r;
        } else {
          q = r * inverse_h;
          weight = other[Record::volume] * constant * K::slope(q) / r;
        }
        Lanes stress[stress_size];
        for (int c = 0; c < stress_size; ++c) stress[c] = si[c] + other[Record::stress + c];
        if constexpr (ArtificialStress) {
          const Lanes ratio = K::value(q) * at_spacing, square = ratio * ratio, fourth = square * square;
          Lanes extra[tensor], power = 0.0;
          for (int c = 0; c < tensor; ++c) extra[c] = fourth * (ri[c] + other[Record::artificial + c]);
          for (int a = 0; a < dim; ++a)
            for (int b = 0; b < dim; ++b) {
              const Lanes& component = extra[tensor_slot<S>(a < b ? a : b, a < b ? b : a)];
              if (Full || a <= b) stress[stress_slot<S, Full>(axis[a], b)] += component;
              power += component * d[b] * (vi[axis[a]] - other[Record::v + axis[a]]);
            }
          absorbed -= weight * power;
        }
        if constexpr (Viscous) {
          Lanes approach = 0.0;
          for (int a = 0; a < dim; ++a)
            approach += OwnVelocity ? Lanes((wi[axis[a]] - other[Record::own + axis[a]]) * d[a])
                                    : Lanes((vi[axis[a]] - other[Record::v + axis[a]]) * d[a]);
          [[maybe_unused]] const Lanes whole = approach;
          approach = min(approach, Lanes(0.0));
          if constexpr (Reconstruct) {
            Lanes own = 0.0, others = 0.0;
            for (int a = 0; a < dim; ++a)
              for (int b = a; b < dim; ++b) {
                const Lanes product = (a == b ? 1.0 : 2.0) * d[a] * d[b];
                own += rate[tensor_slot<S>(a, b)] * product;
                others += other[Record::rate + tensor_slot<S>(a, b)] * product;
              }
            const Lanes sum = own + others;
            // phi (p_i + p_j)/2 with the limiter written out; tiny keeps 0/0 away.
            const Lanes explained = max(Lanes(0.0), 2.0 * own * others) * sum / (sum * sum + tiny_square);
            approach = max(approach, min(Lanes(0.0), whole - explained));
          }
          const Lanes mu = h * approach / (r2 + 0.01 * h * h);
          Lanes pressure = 0.5 * mu *
                           (constants.beta * (density + other[Record::density]) * mu -
                            constants.alpha * (impedance + other[Record::impedance]));
          if constexpr (across < S >> 0)  // the mean circumference of the two rings
            pressure *= std::numbers::pi * (abs(xi[0]) + std::abs(other[Record::x]));
          for (int a = 0; a < dim; ++a) stress[stress_slot<S, Full>(axis[a], a)] -= pressure;
          if constexpr (Reconstruct && !OwnVelocity) approach = whole;
          if constexpr (OwnVelocity) {  // what it takes is decided by the whole velocity
            approach = 0.0;
            for (int a = 0; a < dim; ++a) approach += (vi[axis[a]] - other[Record::v + axis[a]]) * d[a];
          }
          dissipated += pressure * weight * approach;
        }
        for (int a = 0; a < components; ++a) {
          Lanes traction = stress[stress_slot<S, Full>(a, 0)] * d[0];
          for (int b = 1; b < dim; ++b) traction += stress[stress_slot<S, Full>(a, b)] * d[b];
          share[a] = weight * traction;
          f[a] += share[a];
        }
      };

      Lanes share[components];
      for (std::size_t j = cluster * cluster_size; j < (cluster + 1) * cluster_size; ++j)
        visit(static_cast<std::int32_t>(j), share);
      const auto [shared, halo] = active.of(cluster, part / lanes);
      for (const std::int32_t j : halo) visit(j, share);
      dissipated *= 0.5;  // the other half is counted from the other side
      absorbed *= 0.5;

      for (std::size_t begin = 0; begin < shared.size(); begin += lanes) {
        const std::size_t count = std::min(lanes, shared.size() - begin);
        for (std::size_t k = 0; k < count; ++k) {
          visit(shared[begin + k], share);
          for (int a = 0; a < components; ++a) (volume * share[a]).copy_to(&shares[a][k * lanes], stdx::vector_aligned);
        }
        for (int a = 0; a < components; ++a) sum_rows(shares[a], sums[a]);
        for (std::size_t k = 0; k < count; ++k)
          for (int a = 0; a < components; ++a) force[a][shared[begin + k]] -= sums[a][k];
      }

      for (int a = 0; a < components; ++a) {
        double* const at = force[a] + i0;
        (Lanes(at, stdx::element_aligned) + f[a] * volume).copy_to(at, stdx::element_aligned);
      }
      Lanes(dissipated * volume).copy_to(dissipation + i0, stdx::element_aligned);
      if constexpr (ArtificialStress) Lanes(absorbed * volume).copy_to(artificial_power + i0, stdx::element_aligned);
    }
  }
}

}  // namespace stirsph
