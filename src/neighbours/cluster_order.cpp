#include "neighbours/cluster_order.hpp"

#include <algorithm>
#include <array>
#include <span>

#include "particles/field_names.hpp"

namespace stirsph {
namespace {

struct Item {
  std::array<double, 3> x;
  double id;
  std::int32_t index;
};

void halve(std::span<Item> items, int dim) {
  if (items.size() <= cluster_size) {
    std::sort(items.begin(), items.end(), [](const Item& a, const Item& b) { return a.id < b.id; });
    return;
  }
  std::array<double, 3> low = items[0].x, high = items[0].x;
  for (const Item& item : items)
    for (int d = 0; d < dim; ++d) {
      low[d] = std::min(low[d], item.x[d]);
      high[d] = std::max(high[d], item.x[d]);
    }
  int axis = 0;
  for (int d = 1; d < dim; ++d)
    // a little preference for the first axis keeps the choice stable when round-off perturbs equal sides
    if (high[d] - low[d] > 1.0001 * (high[axis] - low[axis])) axis = d;
  const std::size_t clusters = (items.size() + cluster_size - 1) / cluster_size;
  const std::size_t middle = clusters / 2 * cluster_size;
  std::nth_element(items.begin(), items.begin() + middle, items.end(), [axis](const Item& a, const Item& b) {
    return a.x[axis] != b.x[axis] ? a.x[axis] < b.x[axis] : a.id < b.id;
  });
  halve(items.first(middle), dim);
  halve(items.subspan(middle), dim);
}

}  // namespace

std::vector<std::int32_t> cluster_order(const ParticleSet& particles) {
  const int dim = particles.layout().dim;
  std::vector<Item> items(particles.owned());
  for (std::size_t i = 0; i < items.size(); ++i) {
    for (int d = 0; d < dim; ++d) items[i].x[d] = particles.component(field::position, d)[i];
    items[i].id = particles[field::id][i];
    items[i].index = static_cast<std::int32_t>(i);
  }
  halve(items, dim);
  std::vector<std::int32_t> order(items.size());
  std::transform(items.begin(), items.end(), order.begin(), [](const Item& item) { return item.index; });
  return order;
}

}  // namespace stirsph
