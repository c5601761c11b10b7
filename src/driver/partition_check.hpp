/// `stirsph check --partition`: what METIS would make of a scene on many ranks, computed on one.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "base/comm.hpp"
#include "scene/scene.hpp"

namespace stirsph {

/// Largest number of parts that may be asked for.
inline constexpr int most_parts = 1 << 20;

/// What one rank would hold and exchange.
struct PartShare {
  std::int64_t particles = 0;
  std::int64_t candidates = 0;  ///< entries of its pair list
  double cost = 0;              ///< of a step, in units of step_cost.hpp
  std::int64_t sent = 0;        ///< halo copies that leave in one exchange, images of its own particles included
  std::int64_t received = 0;
  int destinations = 0;  ///< other ranks it sends to
  int sources = 0;       ///< other ranks it receives from
};

struct Partition {
  int parts = 0;
  bool by_work = false;      ///< cut again by measured work, because by particles alone it was too uneven
  double metis_seconds = 0;  ///< of making the graph and cutting it, on rank 0 of a run while the others wait
  double list_seconds = 0;   ///< mean over the parts: storage order, halo plan and pair list with its halo copies
  std::vector<PartShare> shares;
  /// Most loaded part over the mean, by cost: what the run compares with numerics.repartition_imbalance.
  double imbalance() const;
};

struct PartitionStudy {
  std::int64_t particles = 0, cells = 0;
  double repartition_imbalance = 0;                    ///< the scene's threshold
  std::int64_t kinematic_bytes = 0, stress_bytes = 0;  ///< of one halo copy in the two exchanges of a step
  double rebuild_seconds = 0;                          ///< list, order and halo plan of all particles on one rank
  double table_seconds = 0;  ///< share of a rebuild that every rank does for all cells, however many ranks there are
  std::vector<Partition> partitions;
};

/// Fills the bodies of the scene and cuts the cells as a run on that many ranks does: first by particles, and by work
/// if that leaves it more uneven than the scene allows. Pair lists and halo copies of every part are
/// counted by the code that makes them in a run. Rigid bodies are left out, so there is no
/// work of contact. Not collective: the calling rank
/// does all of it.
PartitionStudy study_partitions(const Scene& scene, const std::vector<int>& part_counts);
/// The same on the root: prints the table and, unless `file` is empty, writes the CSV. Collective.
void report_partitions(const Comm& comm, const Scene& scene, const std::vector<int>& part_counts,
                       const std::string& file);

/// A table for people: one row per number of parts.
std::string partition_table(const PartitionStudy& study);
/// Every share: lines "# key=value", a line of column names, one line per part (CSV).
std::string partition_csv(const PartitionStudy& study);

}  // namespace stirsph
