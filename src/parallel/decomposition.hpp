/// Which rank owns which cell, and the migration that makes it so.
#pragma once

#include <span>
#include <vector>

#include "base/comm.hpp"
#include "parallel/cell_table.hpp"
#include "parallel/domain.hpp"
#include "particles/particle_set.hpp"

namespace stirsph {

/// Distributes particles over ranks by cells. Between repartitions a cell follows the rank that holds most of its cost,
/// so ownership drifts with the material and needs no memory of its own; a restart finds it from the particles alone.
class Decomposition {
 public:
  explicit Decomposition(Comm comm) : comm_(comm) {}

  /// Wraps positions into the periodic box, decides the owner of every cell (METIS k-way on the graph of cells when
  /// `repartition`, else the rank with most cost in it) and migrates. Drops halo copies. Collective.
  /// `weights`: cost of each owned particle, empty for equal ones. Returns the table of cells after migration.
  CellTable redistribute(ParticleSet& particles, const Domain& domain, double reach, bool repartition,
                         std::span<const double> weights) const;

 private:
  Comm comm_;
};

/// METIS partition of the graph of occupied cells into `parts`; result over the keys of the table. Vertex weight: cost
/// of the cell; edge weight: the copies a cut would need. The same on all ranks (rank 0 decides).
std::vector<int> partition_cells(const Comm& comm, const CellTable& table, int parts);

}  // namespace stirsph
