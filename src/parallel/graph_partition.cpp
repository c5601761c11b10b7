#include "parallel/graph_partition.hpp"

#include <metis.h>

#include <algorithm>
#include <numeric>

namespace stirsph {
namespace {

std::vector<idx_t> metis_numbers(const std::vector<std::int64_t>& values) { return {values.begin(), values.end()}; }

std::vector<idx_t> metis_partition(const Graph& graph, int parts) {
  std::vector<idx_t> first = metis_numbers(graph.first), adjacent = metis_numbers(graph.adjacent),
                     vertex_weights = metis_numbers(graph.vertex_weights),
                     edge_weights = metis_numbers(graph.edge_weights);
  idx_t vertices = static_cast<idx_t>(graph.vertices()), constraints = 1, count = parts, cut = 0;
  std::vector<idx_t> part(graph.vertices());
  idx_t options[METIS_NOPTIONS];
  METIS_SetDefaultOptions(options);
  options[METIS_OPTION_SEED] = 1;
  // Recursive bisection balances small part counts better; k-way cuts less for many.
  const auto method = parts <= 8 ? METIS_PartGraphRecursive : METIS_PartGraphKway;
  const auto given = [](std::vector<idx_t>& weights) { return weights.empty() ? nullptr : weights.data(); };
  const int status = method(&vertices, &constraints, first.data(), adjacent.data(), given(vertex_weights), nullptr,
                            given(edge_weights), &count, nullptr, nullptr, options, &cut, part.data());
  if (status != METIS_OK) throw Error(ExitCode::Internal, "METIS could not partition a graph");
  return part;
}

}  // namespace

std::vector<int> partition_graph(const Comm& comm, const Graph& graph, int parts) {
  std::vector<std::int64_t> result;
  comm.together([&] {
    if (!comm.is_root()) return;
    result.resize(graph.vertices(), 0);
    if (graph.vertices() <= static_cast<std::size_t>(parts)) {
      std::iota(result.begin(), result.end(), 0);
    } else if (parts > 1) {
      const std::vector<idx_t> part = metis_partition(graph, parts);
      std::copy(part.begin(), part.end(), result.begin());
    }
  });
  comm.broadcast(result);
  return {result.begin(), result.end()};
}

}  // namespace stirsph
