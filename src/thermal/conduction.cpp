#include "thermal/conduction.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "particles/field_names.hpp"

namespace stirsph {
namespace {

/// The candidates of one cluster, sorted and packed, so that the loops over them run over contiguous memory.
template <int Dim>
class PackedCandidates {
 public:
  explicit PackedCandidates(const ParticleSet& particles) {
    for (int d = 0; d < Dim; ++d) source_[d] = particles.component(field::position, d).data();
    source_h_ = particles[field::smoothing_length].data();
  }

  void load(std::span<const std::int32_t> candidates) {
    index.assign(candidates.begin(), candidates.end());
    // Rising columns make the rows of the matrix sorted without sorting each of them.
    if (!std::is_sorted(index.begin(), index.end())) std::sort(index.begin(), index.end());
    const std::size_t n = index.size();
    for (auto& values : x_) values.resize(n);
    h_.resize(n);
    square_.resize(n);
    inside.resize(n);
    r.resize(n);
    h.resize(n);
    for (std::size_t k = 0; k < n; ++k) {
      for (int d = 0; d < Dim; ++d) x_[d][k] = source_[d][index[k]];
      h_[k] = source_h_[index[k]];
    }
  }

  /// Leaves in inside[0 .. result) the positions in `index` of the particles with 0 < r < support h_ij, and r and h_ij.
  std::size_t select(std::size_t i, double support) {
    const std::size_t n = index.size();
    std::array<double, Dim> xi;
    for (int d = 0; d < Dim; ++d) xi[d] = source_[d][i];
    const double hi = source_h_[i];
    for (std::size_t k = 0; k < n; ++k) {
      double sum = 0;
      for (int d = 0; d < Dim; ++d) {
        const double dx = xi[d] - x_[d][k];
        sum += dx * dx;
      }
      square_[k] = sum;
    }
    std::size_t kept = 0;
    for (std::size_t k = 0; k < n; ++k) {
      const double reach = support * 0.5 * (hi + h_[k]);
      inside[kept] = static_cast<std::int32_t>(k);
      r[kept] = square_[k];
      h[kept] = 0.5 * (hi + h_[k]);
      kept += square_[k] < reach * reach && square_[k] > 0;
    }
    for (std::size_t k = 0; k < kept; ++k) r[k] = std::sqrt(r[k]);
    return kept;
  }

  std::vector<std::int32_t> index, inside;
  std::vector<double> r, h;

 private:
  std::array<const double*, Dim> source_;
  const double* source_h_;
  std::array<std::vector<double>, Dim> x_;
  std::vector<double> h_, square_;
};

template <int Dim>
double power(double h) {
  return Dim == 2 ? h * h : h * h * h;
}

template <class K, int Dim>
void correction(ParticleSet& particles, const PairList& pairs, double bulk_sum, std::span<const double> embedded) {
  const auto volume = particles[field::volume];
  const auto h = particles[field::smoothing_length];
  const auto result = particles[field::conduction_correction];
  constexpr double sigma = K::normalisation(Dim);
  PackedCandidates<Dim> packed(particles);
  for (std::size_t c = 0; c < pairs.clusters(); ++c) {
    packed.load(pairs.candidates(c));
    const std::size_t last = std::min((c + 1) * cluster_size, particles.owned());
    for (std::size_t i = c * cluster_size; i < last; ++i) {
      const std::size_t n = packed.select(i, K::support);
      double sum = volume[i] * sigma / power<Dim>(h[i]) * K::value(0.0) + (embedded.empty() ? 0.0 : embedded[i]);
      for (std::size_t k = 0; k < n; ++k)
        sum += volume[packed.index[packed.inside[k]]] * sigma / power<Dim>(packed.h[k]) *
               K::value(packed.r[k] / packed.h[k]);
      result[i] = bulk_sum / sum;
    }
  }
}

template <class K, int Dim>
void links(const ParticleSet& particles, const PairList& pairs, double lattice_factor,
           const std::function<bool(const HeatLinks&)>& visit) {
  const auto volume = particles[field::volume];
  const auto conductivity = particles[field::conductivity];
  const auto scale = particles[field::conduction_correction];
  constexpr double sigma = K::normalisation(Dim);
  PackedCandidates<Dim> packed(particles);
  std::vector<std::int32_t> neighbours;
  std::vector<double> conductances, coefficient;
  for (std::size_t c = 0; c < pairs.clusters(); ++c) {
    packed.load(pairs.candidates(c));
    neighbours.resize(packed.index.size());
    conductances.resize(packed.index.size());
    coefficient.resize(packed.index.size());
    const std::size_t last = std::min((c + 1) * cluster_size, particles.owned());
    for (std::size_t i = c * cluster_size; i < last; ++i) {
      const std::size_t n = packed.select(i, K::support);
      const double ki = conductivity[i], si = scale[i], vi = volume[i];
      for (std::size_t k = 0; k < n; ++k) {
        const std::int32_t j = packed.index[packed.inside[k]];
        const double kj = conductivity[j];
        neighbours[k] = j;
        // vi vj (ki kj) and the sums are the same to the last bit seen from j: the matrix is exactly symmetric.
        coefficient[k] = ki + kj > 0 ? (vi * volume[j]) * (ki * kj / (ki + kj)) * (si + scale[j]) : 0.0;
      }
      for (std::size_t k = 0; k < n; ++k) {
        const double h = packed.h[k], r = packed.r[k];
        conductances[k] = coefficient[k] * (-2 * sigma / lattice_factor) * K::slope(r / h) / (power<Dim>(h) * h * r);
      }
      if (!visit({i, {neighbours.data(), n}, {conductances.data(), n}})) return;
    }
  }
}

template <class Work>
void dispatch(const Kernel& kernel, int dim, Work&& work) {
  std::visit(
      [&]<class K>(const K&) {
        if (dim == 2)
          work.template operator()<K, 2>();
        else
          work.template operator()<K, 3>();
      },
      kernel);
}

}  // namespace

void update_conduction_correction(ParticleSet& particles, const PairList& pairs, const ConductionOperator& op,
                                  std::span<const double> embedded) {
  dispatch(op.kernel, particles.layout().dim,
           [&]<class K, int Dim>() { correction<K, Dim>(particles, pairs, op.bulk_sum, embedded); });
}

void visit_heat_links(const ParticleSet& particles, const PairList& pairs, const ConductionOperator& op,
                      const std::function<bool(const HeatLinks&)>& visit) {
  dispatch(op.kernel, particles.layout().dim,
           [&]<class K, int Dim>() { links<K, Dim>(particles, pairs, op.lattice_factor, visit); });
}

std::vector<double> conduction_power(const ParticleSet& particles, const PairList& pairs,
                                     const ConductionOperator& op) {
  std::vector<double> result(particles.owned());
  const auto temperature = particles[field::temperature];
  visit_heat_links(particles, pairs, op, [&](const HeatLinks& row) {
    double sum = 0;
    for (std::size_t k = 0; k < row.neighbours.size(); ++k)
      sum += row.conductances[k] * (temperature[row.neighbours[k]] - temperature[row.particle]);
    result[row.particle] = sum;
    return true;
  });
  return result;
}

}  // namespace stirsph
