#include "parallel/decomposition.hpp"

#include <algorithm>
#include <numeric>

#include "parallel/graph_partition.hpp"
#include "particles/field_names.hpp"

namespace stirsph {
namespace {

std::vector<std::int64_t> distinct_keys(const CellTable& table) {
  std::vector<std::int64_t> keys;
  for (const auto& entry : table.entries())
    if (keys.empty() || keys.back() != entry.key) keys.push_back(entry.key);
  return keys;
}

std::vector<int> owners_by_majority(const CellTable& table, const std::vector<std::int64_t>& keys) {
  std::vector<int> owners;
  owners.reserve(keys.size());
  std::size_t at = 0;
  const auto& entries = table.entries();
  for (std::int64_t key : keys) {
    std::size_t best = at;
    for (; at < entries.size() && entries[at].key == key; ++at)
      if (entries[at].weight > entries[best].weight) best = at;
    owners.push_back(entries[best].rank);
  }
  return owners;
}

/// Sends every particle to the owner of its cell. The order on arrival (by sending rank, then by index) is
/// deterministic.
void migrate(const Comm& comm, ParticleSet& particles, const std::vector<int>& destination) {
  const std::size_t width = particles.state_width();
  const int size = comm.size();
  std::vector<int> send_counts(size, 0), receive_counts(size), send_offsets(size), receive_offsets(size);
  for (int rank : destination) send_counts[rank] += 1;
  check_mpi(MPI_Alltoall(send_counts.data(), 1, MPI_INT, receive_counts.data(), 1, MPI_INT, comm.handle()),
            "MPI_Alltoall");
  std::exclusive_scan(send_counts.begin(), send_counts.end(), send_offsets.begin(), 0);
  std::exclusive_scan(receive_counts.begin(), receive_counts.end(), receive_offsets.begin(), 0);
  const std::size_t incoming = receive_offsets.back() + receive_counts.back();

  std::vector<double> outbox(destination.size() * width), inbox(incoming * width);
  std::vector<int> next = send_offsets;
  for (std::size_t i = 0; i < destination.size(); ++i)
    particles.pack_state(i, outbox.data() + width * static_cast<std::size_t>(next[destination[i]]++));

  MPI_Datatype record;
  check_mpi(MPI_Type_contiguous(static_cast<int>(width), MPI_DOUBLE, &record), "MPI_Type_contiguous");
  check_mpi(MPI_Type_commit(&record), "MPI_Type_commit");
  check_mpi(MPI_Alltoallv(outbox.data(), send_counts.data(), send_offsets.data(), record, inbox.data(),
                          receive_counts.data(), receive_offsets.data(), record, comm.handle()),
            "MPI_Alltoallv");
  check_mpi(MPI_Type_free(&record), "MPI_Type_free");

  particles.resize_owned(incoming);
  for (std::size_t i = 0; i < incoming; ++i) particles.unpack_state(i, inbox.data() + width * i);
}

}  // namespace

std::vector<int> partition_cells(const Comm& comm, const CellTable& table, const std::vector<std::int64_t>& keys,
                                 int parts) {
  Graph graph;
  if (comm.is_root()) {
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
  const std::vector<std::int64_t> keys = distinct_keys(table);
  const std::vector<int> owners =
      repartition ? partition_cells(comm_, table, keys, comm_.size()) : owners_by_majority(table, keys);

  std::vector<int> destination(particles.owned());
  for (std::size_t i = 0; i < destination.size(); ++i) {
    const auto found = std::lower_bound(keys.begin(), keys.end(), table.particle_keys()[i]);
    destination[i] = owners[found - keys.begin()];
  }
  migrate(comm_, particles, destination);
  table.set_owners(keys, owners);
  return table;
}

}  // namespace stirsph
