/// The occupied cells of space and which ranks have particles in them: the same small table on every rank. Cells are at
/// least as wide as the interaction reach, so a particle's neighbours sit in its own and the adjacent cells.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "base/comm.hpp"
#include "parallel/domain.hpp"
#include "particles/particle_set.hpp"

namespace stirsph {

/// Integer coordinates of a cell.
using CellIndex = std::array<std::int64_t, 3>;

class CellTable {
 public:
  /// Collective. `reach` [m]: kernel support plus skin. `weights`: cost of each owned particle, or empty for 1 each.
  /// Throws BlowUp on all ranks when a position is not finite or too far away to be counted.
  CellTable(const Comm& comm, const ParticleSet& particles, const Domain& domain, double reach,
            std::span<const double> weights = {});

  struct Presence {
    std::int64_t key;
    int rank;
    double weight;
  };
  struct Neighbour {
    std::int64_t key;  ///< wrapped into the periodic box
    Vec3 shift;        ///< m: add to a particle of the asking cell to see it from the neighbour cell
    CellIndex index;   ///< unwrapped coordinates of the neighbour cell in the asking particle's frame
    bool image;        ///< true when the shift is not zero
  };

  CellIndex index_of(const Vec3& position) const;
  std::int64_t key_of(const Vec3& position) const;
  /// All ranks with particles in this cell; empty for an empty cell.
  std::span<const Presence> ranks_in(std::int64_t key) const;
  /// The cells around one cell (itself included, without its zero-shift self last), across periodic faces as well.
  std::vector<Neighbour> around(const CellIndex& cell) const;
  /// Distance [m] from a point to the box of a cell.
  double distance_to_cell(const Vec3& point, const CellIndex& cell) const;

  const Domain& domain() const { return domain_; }
  const std::vector<Presence>& entries() const { return entries_; }
  CellIndex decode(std::int64_t key) const;
  /// The keys of all occupied cells, in order.
  const std::vector<std::int64_t>& keys() const { return keys_; }
  /// For each owned particle the place of its cell in `keys()`.
  const std::vector<std::int32_t>& particle_cells() const { return particle_cells_; }
  /// Says that every cell now belongs wholly to the given owner (after migration); `owners` runs over `keys()`.
  void set_owners(const std::vector<int>& owners);

 private:
  std::int64_t encode(const CellIndex& cell) const;

  Domain domain_;
  std::array<double, 3> size_{1, 1, 1};   ///< m
  std::array<std::int64_t, 3> period_{};  ///< cells per period, 0 when not periodic
  std::array<std::int64_t, 3> spread_{};  ///< how many cells away neighbours may be
  std::vector<Presence> entries_;         ///< sorted by key, then rank
  std::vector<std::int64_t> keys_;
  std::vector<std::int32_t> particle_cells_;
};

/// Numbers distinct keys in order of appearance. Neighbouring particles mostly ask for the same key again.
class KeyNumbers {
 public:
  /// The number of a key, a new one when it was not seen before.
  std::int32_t number(std::int64_t key);
  const std::vector<std::int64_t>& keys() const { return keys_; }

 private:
  void grow();
  std::size_t start_of(std::int64_t key) const;

  std::vector<std::int64_t> keys_;
  std::vector<std::int32_t> table_;  ///< open addressing; -1: free
  std::int32_t last_ = -1;
};

}  // namespace stirsph
