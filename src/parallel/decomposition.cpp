#include "parallel/decomposition.hpp"

#include <algorithm>
#include <numeric>

#include "parallel/graph_partition.hpp"
#include "particles/field_names.hpp"

namespace stirsph {
namespace {

std::vector<int> owners_by_majority(const CellTable& table) {
  std::vector<int> owners;
  owners.reserve(table.keys().size());
  std::size_t at = 0;
  const auto& entries = table.entries();
  for (const std::int64_t key : table.keys()) {
    std::size_t best = at;
    for (; at < entries.size() && entries[at].key == key; ++at)
      if (entries[at].weight > entries[best].weight) best = at;
    owners.push_back(entries[best].rank);
  }
  return owners;
}

/// Sends the particles that change owner. Those that stay keep their place, but for some that fill the gaps; arrivals
/// stand behind them by sending rank. Fields that are not state lose their meaning.
void migrate(const Comm& comm, ParticleSet& particles, const std::vector<int>& destination) {
  const std::size_t width = particles.state_width();
  const int size = comm.size();
  std::vector<std::vector<double>> outgoing(size);
  std::vector<std::size_t> leavers;
  for (std::size_t i = 0; i < destination.size(); ++i) {
    if (destination[i] == comm.rank()) continue;
    leavers.push_back(i);
    auto& outbox = outgoing[destination[i]];
    outbox.resize(outbox.size() + width);
    particles.pack_state(i, outbox.data() + outbox.size() - width);
  }
  const std::vector<double> inbox = comm.exchange(outgoing);

  std::size_t staying = particles.owned();
  std::vector<double> record(width);
  for (auto gap = leavers.rbegin(); gap != leavers.rend(); ++gap) {
    staying -= 1;
    if (*gap == staying) continue;
    particles.pack_state(staying, record.data());
    particles.unpack_state(*gap, record.data());
  }
  const std::size_t arrivals = inbox.size() / width;
  if (leavers.empty() && arrivals == 0) return;
  particles.resize_owned(staying + arrivals);
  for (std::size_t k = 0; k < arrivals; ++k) particles.unpack_state(staying + k, inbox.data() + width * k);
}

}  // namespace

std::vector<int> partition_cells(const Comm& comm, const CellTable& table, int parts) {
  Graph graph;
  if (comm.is_root()) {
    const std::vector<std::int64_t>& keys = table.keys();
    const std::size_t n = keys.size();
    std::vector<double> cost(n, 0);
    std::size_t at = 0;
    for (std::size_t k = 0; k < n; ++k)
      for (; at < table.entries().size() && table.entries()[at].key == keys[k]; ++at)
        cost[k] += table.entries()[at].weight;
    const double largest = n > 0 ? *std::max_element(cost.begin(), cost.end()) : 1.0;
    const auto scaled = [&](double value) {
      return std::max<std::int64_t>(1, static_cast<std::int64_t>(1000 * value / largest));
    };
    for (std::size_t k = 0; k < n; ++k) {
      graph.vertex_weights.push_back(scaled(cost[k]));
      std::vector<std::size_t> seen;
      for (const auto& neighbour : table.around(table.decode(keys[k]))) {
        const auto found = std::lower_bound(keys.begin(), keys.end(), neighbour.key);
        if (found == keys.end() || *found != neighbour.key) continue;
        const std::size_t other = found - keys.begin();
        if (other == k || std::find(seen.begin(), seen.end(), other) != seen.end()) continue;
        seen.push_back(other);
        graph.adjacent.push_back(static_cast<std::int64_t>(other));
        graph.edge_weights.push_back(scaled(cost[k]) + scaled(cost[other]));
      }
      graph.first.push_back(static_cast<std::int64_t>(graph.adjacent.size()));
    }
  }
  return partition_graph(comm, graph, parts);
}

CellTable Decomposition::redistribute(ParticleSet& particles, const Domain& domain, double reach, bool repartition,
                                      std::span<const double> weights) const {
  particles.resize_halo(0);
  for (int d = 0; d < domain.dim; ++d) {
    if (!domain.periodic[d]) continue;
    auto x = particles.component(field::position, d);
    for (std::size_t i = 0; i < particles.owned(); ++i)
      if (std::isfinite(x[i])) x[i] = domain.wrap(x[i], d);
  }
  CellTable table(comm_, particles, domain, reach, weights);
  const std::vector<int> owners = repartition ? partition_cells(comm_, table, comm_.size()) : owners_by_majority(table);

  std::vector<int> destination(particles.owned());
  for (std::size_t i = 0; i < destination.size(); ++i) destination[i] = owners[table.particle_cells()[i]];
  migrate(comm_, particles, destination);
  table.set_owners(owners);
  return table;
}

}  // namespace stirsph
