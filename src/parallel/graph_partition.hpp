/// METIS partition of a graph: the one place where work is split among ranks.
#pragma once

#include <cstdint>
#include <vector>

#include "base/comm.hpp"

namespace stirsph {

/// An undirected graph in compressed form: neighbours of vertex v are adjacent[first[v]] .. adjacent[first[v + 1] - 1],
/// each edge listed from both ends. Weights are whole numbers >= 1; empty for equal ones.
struct Graph {
  std::vector<std::int64_t> first{0}, adjacent;
  std::vector<std::int64_t> vertex_weights, edge_weights;
  std::size_t vertices() const { return first.size() - 1; }
};

/// Part of each vertex, balanced by vertex weight with a small weight of cut edges. Collective; rank 0 decides and only
/// its graph counts. With no more vertices than parts each vertex is a part of its own.
std::vector<int> partition_graph(const Comm& comm, const Graph& graph, int parts);

}  // namespace stirsph
