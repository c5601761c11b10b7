#include "neighbours/cluster_order.hpp"

#include <algorithm>
#include <array>
#include <span>

#include "particles/field_names.hpp"

namespace stirsph {
namespace {

/// Coordinates and, as the fourth value, the index: one vector register, so that boxes and moves cost little.
struct alignas(32) Item {
  std::array<double, 4> x;
  std::int32_t index() const { return static_cast<std::int32_t>(x[3]); }
};

class Halving {
 public:
  Halving(const double* ids, int dim) : ids_(ids), dim_(dim) {}

  void halve(std::span<Item> items) const {
    if (items.size() <= cluster_size) {
      std::sort(items.begin(), items.end(), [this](const Item& a, const Item& b) { return id(a) < id(b); });
      return;
    }
    std::array<double, 4> low = items[0].x, high = items[0].x;
    for (const Item& item : items)
      for (int d = 0; d < 4; ++d) {
        low[d] = std::min(low[d], item.x[d]);
        high[d] = std::max(high[d], item.x[d]);
      }
    int axis = 0;
    for (int d = 1; d < dim_; ++d)
      // a little preference for the first axis keeps the choice stable when round-off perturbs equal sides
      if (high[d] - low[d] > 1.0001 * (high[axis] - low[axis])) axis = d;
    const std::size_t clusters = (items.size() + cluster_size - 1) / cluster_size;
    const std::size_t middle = clusters / 2 * cluster_size;
    select(items, middle, axis, low[axis], high[axis]);
    halve(items.first(middle));
    halve(items.subspan(middle));
  }

 private:
  double id(const Item& item) const { return ids_[item.index()]; }

  /// As std::nth_element by coordinate, then id. Coordinates fill their range rather evenly, so a pivot by
  /// interpolation leaves little to do after two passes, which have no branch to predict.
  void select(std::span<Item> items, std::size_t k, int axis, double low, double high) const {
    std::size_t first = 0, last = items.size();
    while (last - first > 64) {
      const double aim = (static_cast<double>(k - first) + 0.5) / static_cast<double>(last - first);
      const double pivot = low + (high - low) * (aim + 0.1 * (0.5 - aim));  // rather enclose k than graze it
      std::size_t below = first;
      for (std::size_t i = first; i < last; ++i) {
        const Item item = items[i];
        items[i] = items[below];
        items[below] = item;
        below += item.x[axis] < pivot;
      }
      if (below == first || below == last) break;  // many equal coordinates
      (k < below ? last : first) = below;
      (k < below ? high : low) = pivot;
    }
    std::nth_element(items.begin() + first, items.begin() + k, items.begin() + last,
                     [this, axis](const Item& a, const Item& b) {
                       return a.x[axis] != b.x[axis] ? a.x[axis] < b.x[axis] : id(a) < id(b);
                     });
  }

  const double* ids_;
  int dim_;
};

}  // namespace

std::vector<std::int32_t> cluster_order(const ParticleSet& particles) {
  const int dim = particles.layout().dim;
  std::vector<Item> items(particles.owned());
  for (int d = 0; d < dim; ++d) {
    const double* x = particles.component(field::position, d).data();
    for (std::size_t i = 0; i < items.size(); ++i) items[i].x[d] = x[i];
  }
  for (std::size_t i = 0; i < items.size(); ++i) items[i].x[3] = static_cast<double>(i);
  Halving(particles[field::id].data(), dim).halve(items);
  std::vector<std::int32_t> order(items.size());
  std::transform(items.begin(), items.end(), order.begin(), [](const Item& item) { return item.index(); });
  return order;
}

}  // namespace stirsph
