#include "neighbours/pair_list.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <experimental/simd>

#include "particles/field_names.hpp"

namespace stirsph {
namespace {

namespace stdx = std::experimental;
constexpr std::size_t fan = 8;  ///< boxes under one box, and particles in one of the smallest
using Eight = stdx::fixed_size_simd<double, fan>;

Eight load(const double* from) { return Eight(from, stdx::element_aligned); }

/// Writes first + k for each k with distance2[k] <= reach2; room for all 8 is needed. Returns the next free place.
std::int32_t* keep(const Eight& distance2, double reach2, std::int32_t first, std::int32_t* out) {
  std::array<double, fan> values;
  distance2.copy_to(values.data(), stdx::element_aligned);
  for (std::size_t k = 0; k < fan; ++k) {
    *out = first + static_cast<std::int32_t>(k);
    out += values[k] <= reach2;
  }
  return out;
}

/// A box around the particles of a cluster.
struct Box {
  std::array<double, 3> low, high;
};

/// Boxes around blocks of 8 consecutive particles, boxes around 8 consecutive boxes, and so on to a single one.
/// The storage order is compact in space, so this tree needs no sorting and does not mind how far particles scatter.
template <int Dim>
class BoxTree {
 public:
  BoxTree(std::array<const double*, 3> x, std::size_t particles) {
    Level boxes = Level::of((particles + fan - 1) / fan);
    for (int d = 0; d < Dim; ++d)
      for (std::size_t i = 0; i < particles; ++i) boxes.include(d, i / fan, x[d][i], x[d][i]);
    levels_.push_back(std::move(boxes));
    while (levels_.back().count > 1) {
      const Level& below = levels_.back();
      Level above = Level::of((below.count + fan - 1) / fan);
      for (int d = 0; d < Dim; ++d)
        for (std::size_t b = 0; b < below.count; ++b) above.include(d, b / fan, below.low[d][b], below.high[d][b]);
      levels_.push_back(std::move(above));
    }
  }

  Box box(std::size_t block) const {
    Box box{};
    for (int d = 0; d < Dim; ++d) {
      box.low[d] = levels_[0].low[d][block];
      box.high[d] = levels_[0].high[d][block];
    }
    return box;
  }

  /// The blocks whose box lies within the distance sqrt(reach2) of `box`, in storage order.
  void near(const Box& box, double reach2, std::vector<std::int32_t>& found) const {
    found.clear();
    descend(levels_.size() - 1, 0, box, reach2, found);
  }

 private:
  /// Padded to whole groups of 8 by boxes that are far from everything.
  struct Level {
    std::size_t count = 0;
    std::array<std::vector<double>, 3> low, high;

    static Level of(std::size_t count) {
      Level level;
      level.count = count;
      for (int d = 0; d < Dim; ++d) {
        level.low[d].assign((count + fan - 1) / fan * fan, far);
        level.high[d].assign((count + fan - 1) / fan * fan, -far);
      }
      return level;
    }
    void include(int d, std::size_t b, double least, double most) {
      low[d][b] = std::min(low[d][b], least);
      high[d][b] = std::max(high[d][b], most);
    }
  };
  static constexpr double far = 1e150;

  /// Tests the 8 boxes of a group of this level and follows those that are near.
  void descend(std::size_t level, std::size_t group, const Box& box, double reach2,
               std::vector<std::int32_t>& found) const {
    const Level& boxes = levels_[level];
    Eight distance2 = 0.0;
    for (int d = 0; d < Dim; ++d) {
      const Eight below = load(boxes.low[d].data() + group * fan) - box.high[d];
      const Eight above = box.low[d] - load(boxes.high[d].data() + group * fan);
      const Eight gap = stdx::max(stdx::max(below, above), Eight(0.0));
      distance2 += gap * gap;
    }
    std::array<std::int32_t, fan> near;
    const auto first = static_cast<std::int32_t>(group * fan);
    const std::size_t count = keep(distance2, reach2, first, near.data()) - near.data();
    if (level == 0)
      found.insert(found.end(), near.begin(), near.begin() + count);
    else
      for (std::size_t k = 0; k < count; ++k) descend(level - 1, near[k], box, reach2, found);
  }

  std::vector<Level> levels_;
};

/// Squared distance of each particle of a block to the nearest member of the cluster.
template <int Dim>
Eight nearest2(const std::array<std::array<double, cluster_size>, 3>& members, const std::array<const double*, 3>& x,
               std::int32_t first) {
  std::array<Eight, 3> y;
  for (int d = 0; d < Dim; ++d) y[d] = load(x[d] + first);
  Eight nearest = 1e300;
  for (std::size_t member = 0; member < cluster_size; ++member) {
    Eight r2 = 0.0;
    for (int d = 0; d < Dim; ++d) {
      const Eight dx = members[d][member] - y[d];
      r2 += dx * dx;
    }
    nearest = stdx::min(nearest, r2);
  }
  return nearest;
}

}  // namespace

template <int Dim>
void PairList::collect(const ParticleSet& particles, double reach) {
  const double reach2 = reach * reach;
  std::array<const double*, 3> x{};
  for (int d = 0; d < Dim; ++d) x[d] = particles.component(field::position, d).data();
  const BoxTree<Dim> tree(x, particles.total());
  const std::size_t clusters = particles.clusters();
  std::vector<std::int32_t> blocks;
  std::size_t used = 0;
  indices_.resize(indices_.capacity());
  for (std::size_t c = 0; c < clusters; ++c) {
    const std::size_t first = c * cluster_size, last = std::min(first + cluster_size, particles.owned());
    std::array<std::array<double, cluster_size>, 3> members{};
    Box box{};
    for (int d = 0; d < Dim; ++d) {
      // A partly filled cluster repeats its last particle.
      for (std::size_t k = 0; k < cluster_size; ++k) members[d][k] = x[d][std::min(first + k, last - 1)];
      box.low[d] = *std::min_element(members[d].begin(), members[d].end());
      box.high[d] = *std::max_element(members[d].begin(), members[d].end());
    }
    // Boxes round differently from distances.
    tree.near(box, reach2 * (1 + 1e-12), blocks);
    if (const std::size_t needed = used + blocks.size() * fan; indices_.size() < needed) {
      indices_.reserve(needed + needed / 4);
      indices_.resize(indices_.capacity());
    }
    std::int32_t* out = indices_.data() + used;
    for (const std::int32_t block : blocks) {
      const std::int32_t i = block * static_cast<std::int32_t>(fan);
      out = keep(nearest2<Dim>(members, x, i), reach2, i, out);
    }
    // The padding behind the last particle holds any numbers.
    const auto total = static_cast<std::int32_t>(particles.total());
    while (out != indices_.data() + used && out[-1] >= total) --out;
    used = static_cast<std::size_t>(out - indices_.data());
    starts_.push_back(used);
    const auto behind =
        std::lower_bound(indices_.data() + starts_[c], out, static_cast<std::int32_t>(first + cluster_size));
    behind_.push_back(static_cast<std::uint32_t>(out - behind));
    const bool last_is_halo = used > 0 && indices_[used - 1] >= static_cast<std::int32_t>(particles.owned());
    needs_halo_.push_back(last_is_halo || (c + 1) * cluster_size > particles.owned());
  }
  indices_.resize(used);
  if (indices_.capacity() > used + used / 8) {  // the first list, whose length was a surprise
    std::vector<std::int32_t> fitting;
    fitting.reserve(used + used / 16);
    fitting.assign(indices_.begin(), indices_.end());
    indices_ = std::move(fitting);
  }
}

void PairList::build(const ParticleSet& particles, double reach) {
  version_ += 1;
  starts_.assign(1, 0);
  needs_halo_.clear();
  behind_.clear();
  if (particles.owned() == 0) {
    indices_.clear();
    return;
  }
  if (particles.layout().dim == 2)
    collect<2>(particles, reach);
  else
    collect<3>(particles, reach);
}

}  // namespace stirsph
