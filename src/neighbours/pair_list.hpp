/// Cluster pair lists: for every cluster of 8 owned particles the particles (owned or halo) that may come within the
/// kernel support of one of them while the list lives.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "particles/particle_set.hpp"

namespace stirsph {

class PairList {
 public:
  /// Builds the list for the present positions. `reach` [m] is kernel support plus skin. The order of a
  /// cluster's candidates follows from positions and storage order alone, so sums repeat bit for bit. Halo copies must
  /// be up to date.
  void build(const ParticleSet& particles, double reach);

  std::size_t clusters() const { return starts_.empty() ? 0 : starts_.size() - 1; }
  /// Local indices j of the candidates of cluster c in ascending order; contains the cluster's own particles.
  std::span<const std::int32_t> candidates(std::size_t c) const {
    return {indices_.data() + starts_[c], indices_.data() + starts_[c + 1]};
  }
  /// Those up to the cluster's own last particle, and those behind it.
  std::span<const std::int32_t> candidates_before_end(std::size_t c) const {
    return candidates(c).first(candidates(c).size() - behind_[c]);
  }
  std::span<const std::int32_t> candidates_behind(std::size_t c) const { return candidates(c).last(behind_[c]); }
  /// Whether a cluster of [first, last) has halo copies among its candidates or fills up its registers with them.
  bool needs_halo(std::size_t first, std::size_t last) const {
    return std::find(needs_halo_.begin() + first, needs_halo_.begin() + last, 1) != needs_halo_.begin() + last;
  }
  /// Number of candidates over all clusters.
  std::size_t size() const { return indices_.size(); }
  /// Grows by one with every build: lets others reuse what they derived from the list.
  std::uint64_t version() const { return version_; }
  std::size_t bytes() const {
    return indices_.capacity() * sizeof(std::int32_t) + starts_.capacity() * sizeof(std::size_t) +
           behind_.capacity() * sizeof(std::uint32_t) + needs_halo_.capacity();
  }

 private:
  template <int Dim>
  void collect(const ParticleSet& particles, double reach);

  std::vector<std::size_t> starts_;
  std::vector<std::int32_t> indices_;
  std::vector<std::uint32_t> behind_;  ///< per cluster, how many candidates are behind it
  std::vector<char> needs_halo_;       ///< per cluster
  std::uint64_t version_ = 0;
};

}  // namespace stirsph
