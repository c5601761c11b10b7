/// The rows of the heat matrix that belong to one rank, in compressed form, ready to be used by PETSc without a copy.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace stirsph {

/// Rows first_row .. first_row + rows() - 1. Two blocks: `own` holds the columns of this rank with local numbers, `far`
/// the others with global numbers. Columns rise within a row.
struct HeatMatrix {
  struct Block {
    std::vector<int> starts, columns;
    std::vector<double> values;
  };
  std::int64_t first_row = 0;
  Block own, far;
  std::size_t rows() const { return own.starts.empty() ? 0 : own.starts.size() - 1; }
  std::size_t bytes() const;
};

/// Writes a HeatMatrix row by row. First into the present pattern; when a column differs, `fits()` becomes false and
/// the pattern must be made anew by a second pass with `fresh`.
class HeatMatrixWriter {
 public:
  HeatMatrixWriter(HeatMatrix& matrix, std::int64_t first_row, std::size_t rows, bool fresh);

  bool fits() const { return fits_; }

  /// A whole row within this rank: columns rising, the diagonal among them.
  void add_own_row(std::span<const int> columns, std::span<const double> values);

  void begin_row() { own_.clear(), far_.clear(); }
  /// Entries may come in any order and several times per column; the cheap way is rising columns.
  void add_local(std::int64_t column, double value) { own_.push_back({column, value}); }
  void add_global(std::int64_t column, double value) {
    if (column >= first_row_ && column < first_row_ + static_cast<std::int64_t>(rows_))
      own_.push_back({column - first_row_, value});
    else
      far_.push_back({column, value});
  }
  void end_row();

 private:
  struct Entry {
    std::int64_t column;
    double value;
  };
  static void sort_and_merge(std::vector<Entry>& entries);
  void store(HeatMatrix::Block& block, const std::vector<Entry>& entries);
  void make_room(HeatMatrix::Block& block, std::size_t added) const;

  HeatMatrix& matrix_;
  std::int64_t first_row_;
  std::size_t rows_, row_ = 0;
  bool fresh_, fits_ = true;
  std::vector<Entry> own_, far_;
};

}  // namespace stirsph
