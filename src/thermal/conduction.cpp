#include "thermal/conduction.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "particles/field_names.hpp"
#include "thermal/ring.hpp"

namespace stirsph {
namespace {

/// The candidates of one cluster, sorted and packed, so that the loops over them run over contiguous memory.
template <int Dim>
class PackedCandidates {
 public:
  explicit PackedCandidates(const ParticleSet& particles) : rings_(particles.layout().axisymmetric()) {
    for (int d = 0; d < Dim; ++d) source_[d] = particles.component(field::position, d).data();
    source_h_ = particles[field::smoothing_length].data();
  }

  void load(std::span<const std::int32_t> candidates) {
    index.assign(candidates.begin(), candidates.end());
    if (rings_) std::erase_if(index, [&](std::int32_t j) { return is_mirror_image(source_[0][j]); });
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
  bool rings_;
  std::array<const double*, Dim> source_;
  const double* source_h_;
  std::array<std::vector<double>, Dim> x_;
  std::vector<double> h_, square_;
};

/// Kernel sum of a ring over mirror images at the axis, its own among them. Their originals are nearer and therefore
/// among the candidates; `area`: of all particles.
template <class K>
double mirror_sum(const ParticleSet& particles, std::span<const std::int32_t> candidates, std::size_t i,
                  const std::vector<double>& area) {
  const auto r = particles.component(field::position, 0), z = particles.component(field::position, 1);
  const auto h = particles[field::smoothing_length];
  double sum = 0;
  for (const std::int32_t j : candidates) {
    const double mean_h = 0.5 * (h[i] + h[j]), across = r[i] + r[j];
    if (across < K::support * mean_h) sum += area[j] * kernel_value<K>(std::hypot(across, z[i] - z[j]), mean_h, 2);
  }
  return sum;
}

template <int Dim>
double power(double h) {
  return Dim == 2 ? h * h : h * h * h;
}

/// Room for all rows, guessed from those so far: doubling would leave up to half of two of the largest arrays of the
/// program unused.
void reserve_rows(std::vector<double>& factors, std::vector<std::int32_t>& neighbours, std::size_t needed,
                  std::size_t row, std::size_t rows) {
  if (needed <= factors.capacity()) return;
  const double share = static_cast<double>(rows) / static_cast<double>(row + 1);
  const auto guess = static_cast<std::size_t>(1.03 * static_cast<double>(needed) * std::min(share, 8.0));
  factors.reserve(guess);
  neighbours.reserve(guess);
}

template <class K, int Dim>
void collect(ParticleSet& particles, const PairList& pairs, const ConductionOperator& op,
             std::span<const double> embedded, std::vector<std::size_t>& starts, std::vector<std::int32_t>& neighbours,
             std::vector<double>& factors) {
  const bool rings = particles.layout().axisymmetric();
  const std::vector<double> sections = rings ? ring_sections(particles) : std::vector<double>{};
  const std::span<const double> volume = rings ? std::span<const double>(sections) : particles[field::volume];
  const auto radius = particles.component(field::position, 0);
  const auto h = particles[field::smoothing_length];
  const auto result = particles[field::conduction_correction];
  constexpr double sigma = K::normalisation(Dim);
  PackedCandidates<Dim> packed(particles);
  std::vector<double> other_volume;
  for (std::size_t c = 0; c < pairs.clusters(); ++c) {
    packed.load(pairs.candidates(c));
    other_volume.resize(packed.index.size());
    const std::size_t last = std::min((c + 1) * cluster_size, particles.owned());
    for (std::size_t i = c * cluster_size; i < last; ++i) {
      const std::size_t n = packed.select(i, K::support), first = factors.size();
      reserve_rows(factors, neighbours, first + n, i, particles.owned());
      factors.resize(first + n);
      neighbours.resize(first + n);
      for (std::size_t k = 0; k < n; ++k) {
        neighbours[first + k] = packed.index[packed.inside[k]];
        other_volume[k] = volume[neighbours[first + k]];
      }
      double sum = volume[i] * sigma / power<Dim>(h[i]) * K::value(0.0) + (embedded.empty() ? 0.0 : embedded[i]);
      for (std::size_t k = 0; k < n; ++k) {
        const double hk = packed.h[k], r = packed.r[k], density = sigma / power<Dim>(hk);
        sum += other_volume[k] * density * K::value(r / hk);
        // vi vj and the sums are the same to the last bit seen from j: the matrix is exactly symmetric.
        factors[first + k] =
            (volume[i] * other_volume[k]) * (-2 / op.lattice_factor) * density * K::slope(r / hk) / (hk * r);
      }
      if (rings) {
        for (std::size_t k = 0; k < n; ++k)
          factors[first + k] *= std::numbers::pi * (radius[i] + radius[neighbours[first + k]]);
        sum += mirror_sum<K>(particles, packed.index, i, sections);
      }
      result[i] = op.bulk_sum / sum;
      starts.push_back(factors.size());
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

void HeatGraph::build(ParticleSet& particles, const PairList& pairs, const ConductionOperator& op,
                      std::span<const double> embedded) {
  starts_.assign(1, 0);
  starts_.reserve(particles.owned() + 1);
  neighbours_.clear();
  factors_.clear();
  dispatch(op.kernel, particles.layout().dim, [&]<class K, int Dim>() {
    collect<K, Dim>(particles, pairs, op, embedded, starts_, neighbours_, factors_);
  });
}

std::size_t HeatGraph::bytes() const {
  return starts_.capacity() * sizeof(std::size_t) + neighbours_.capacity() * sizeof(std::int32_t) +
         factors_.capacity() * sizeof(double);
}

LinkEnds::LinkEnds(const ParticleSet& particles) {
  const auto conductivity = particles[field::conductivity], correction = particles[field::conduction_correction],
             temperature = particles[field::temperature];
  ends_.reserve(particles.total());
  for (std::size_t i = 0; i < particles.total(); ++i) ends_.push_back({conductivity[i], correction[i], temperature[i]});
}

std::vector<double> conduction_power(const ParticleSet& particles, const HeatGraph& graph) {
  const LinkEnds ends(particles);
  std::vector<double> result(graph.particles());
  for (std::size_t i = 0; i < graph.particles(); ++i) {
    const auto neighbours = graph.neighbours(i);
    const auto factors = graph.factors(i);
    for (std::size_t k = 0; k < neighbours.size(); ++k)
      result[i] +=
          ends.conductance(i, neighbours[k], factors[k]) * (ends.temperature(neighbours[k]) - ends.temperature(i));
  }
  return result;
}

}  // namespace stirsph
