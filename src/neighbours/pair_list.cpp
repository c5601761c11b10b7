#include "neighbours/pair_list.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "particles/field_names.hpp"

namespace stirsph {
namespace {

/// All particles of this rank sorted into cells: x runs fastest, so a row of cells is one contiguous run of particles.
class LocalGrid {
 public:
  LocalGrid(const ParticleSet& particles, double reach) : dim_(particles.layout().dim) {
    const std::size_t n = particles.total();
    for (int d = 0; d < dim_; ++d) {
      const auto x = particles.component(field::position, d).first(n);
      const auto [least, most] = std::minmax_element(x.begin(), x.end());
      low_[d] = n ? *least : 0;
      high_[d] = n ? *most : 0;
    }
    // About one particle spacing per cell; wider when a stray particle would make the grid sparse and huge.
    size_ = reach / 3;
    for (;;) {
      double cells = 1;
      for (int d = 0; d < dim_; ++d) cells *= std::floor((high_[d] - low_[d]) / size_) + 1;
      if (cells < 8.0 * static_cast<double>(n) + 4096) break;
      size_ *= 1.5;
    }
    for (int d = 0; d < dim_; ++d) count_[d] = static_cast<std::int64_t>((high_[d] - low_[d]) / size_) + 1;

    std::vector<std::int64_t> cell(n);
    starts_.assign(count_[0] * count_[1] * count_[2] + 1, 0);
    for (std::size_t i = 0; i < n; ++i) {
      std::array<std::int64_t, 3> at{};
      for (int d = 0; d < dim_; ++d) at[d] = index(particles.component(field::position, d)[i], d);
      cell[i] = (at[2] * count_[1] + at[1]) * count_[0] + at[0];
      starts_[cell[i] + 1] += 1;
    }
    for (std::size_t c = 1; c < starts_.size(); ++c) starts_[c] += starts_[c - 1];
    std::vector<std::int32_t> next(starts_.begin(), starts_.end() - 1);
    particle_.resize(n);
    for (int d = 0; d < dim_; ++d) x_[d].resize(n);
    for (std::size_t i = 0; i < n; ++i) {
      const std::int32_t k = next[cell[i]]++;
      particle_[k] = static_cast<std::int32_t>(i);
      for (int d = 0; d < dim_; ++d) x_[d][k] = particles.component(field::position, d)[i];
    }
  }

  std::int64_t index(double x, int d) const {
    return std::clamp<std::int64_t>(static_cast<std::int64_t>(std::floor((x - low_[d]) / size_)), 0, count_[d] - 1);
  }

  /// Calls visit(first, last) for each run of cell-sorted particles that may lie in the box.
  template <class Visit>
  void runs(const std::array<double, 3>& low, const std::array<double, 3>& high, Visit&& visit) const {
    std::array<std::int64_t, 3> from{}, to{};
    for (int d = 0; d < dim_; ++d) {
      from[d] = index(low[d], d);
      to[d] = index(high[d], d);
    }
    for (std::int64_t z = from[2]; z <= to[2]; ++z)
      for (std::int64_t y = from[1]; y <= to[1]; ++y) {
        const std::int64_t row = (z * count_[1] + y) * count_[0];
        const std::int32_t first = starts_[row + from[0]], last = starts_[row + to[0] + 1];
        if (first != last) visit(first, last);
      }
  }

  int dim_;
  double size_ = 1;
  std::array<double, 3> low_{}, high_{};
  std::array<std::int64_t, 3> count_{1, 1, 1};
  std::vector<std::int32_t> starts_;
  std::vector<std::int32_t> particle_;
  std::array<std::vector<double>, 3> x_;
};

template <int Dim>
void collect(const ParticleSet& particles, double reach, const LocalGrid& grid, std::vector<std::size_t>& starts,
             std::vector<std::int32_t>& indices) {
  const double reach2 = reach * reach;
  std::array<const double*, 3> x{};
  for (int d = 0; d < Dim; ++d) x[d] = particles.component(field::position, d).data();
  for (std::size_t c = 0; c < particles.clusters(); ++c) {
    const std::size_t first = c * cluster_size, last = std::min(first + cluster_size, particles.owned());
    std::array<std::array<double, cluster_size>, 3> xi{};
    std::array<double, 3> low{}, high{};
    for (int d = 0; d < Dim; ++d) {
      // A partly filled cluster repeats its last particle.
      for (std::size_t k = 0; k < cluster_size; ++k) xi[d][k] = x[d][std::min(first + k, last - 1)];
      low[d] = *std::min_element(xi[d].begin(), xi[d].end()) - reach;
      high[d] = *std::max_element(xi[d].begin(), xi[d].end()) + reach;
    }
    grid.runs(low, high, [&](std::int32_t from, std::int32_t to) {
      const std::size_t old = indices.size();
      indices.resize(old + (to - from));
      std::size_t kept = old;
      for (std::int32_t k = from; k < to; ++k) {
        double nearest = 1e300;
        for (std::size_t l = 0; l < cluster_size; ++l) {
          double r2 = 0;
          for (int d = 0; d < Dim; ++d) {
            const double dx = xi[d][l] - grid.x_[d][k];
            r2 += dx * dx;
          }
          nearest = r2 < nearest ? r2 : nearest;
        }
        indices[kept] = grid.particle_[k];
        kept += nearest <= reach2;
      }
      indices.resize(kept);
    });
    starts.push_back(indices.size());
  }
}

}  // namespace

void PairList::build(const ParticleSet& particles, double reach) {
  version_ += 1;
  starts_.assign(1, 0);
  indices_.clear();
  if (particles.owned() == 0) return;
  const LocalGrid grid(particles, reach);
  if (particles.layout().dim == 2)
    collect<2>(particles, reach, grid, starts_, indices_);
  else
    collect<3>(particles, reach, grid, starts_, indices_);
}

}  // namespace stirsph
