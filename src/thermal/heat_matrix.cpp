#include "thermal/heat_matrix.hpp"

#include <algorithm>
#include <limits>
#include <string>

#include "base/error.hpp"

namespace stirsph {

std::size_t HeatMatrix::bytes() const {
  std::size_t sum = 0;
  for (const Block* block : {&own, &far})
    sum += (block->starts.capacity() + block->columns.capacity()) * sizeof(int) +
           block->values.capacity() * sizeof(double);
  return sum;
}

HeatMatrixWriter::HeatMatrixWriter(HeatMatrix& matrix, std::int64_t first_row, std::size_t rows, bool fresh)
    : matrix_(matrix), first_row_(first_row), rows_(rows), fresh_(fresh) {
  if (fresh) {
    for (HeatMatrix::Block* block : {&matrix.own, &matrix.far}) {
      block->starts.assign(1, 0);
      block->starts.reserve(rows + 1);
      block->columns.clear();
      block->values.clear();
    }
    matrix.first_row = first_row;
  } else {
    fits_ = matrix.first_row == first_row && matrix.rows() == rows;
  }
}

void HeatMatrixWriter::sort_and_merge(std::vector<Entry>& entries) {
  const auto before = [](const Entry& a, const Entry& b) { return a.column < b.column; };
  // Stable, so that the terms of a merged entry are added in the order they came.
  if (!std::is_sorted(entries.begin(), entries.end(), before)) std::stable_sort(entries.begin(), entries.end(), before);
  std::size_t kept = 0;
  for (std::size_t k = 1; k < entries.size(); ++k)
    if (entries[k].column == entries[kept].column)
      entries[kept].value += entries[k].value;
    else
      entries[++kept] = entries[k];
  if (!entries.empty()) entries.resize(kept + 1);
}

void HeatMatrixWriter::make_room(HeatMatrix::Block& block, std::size_t added) const {
  const std::size_t needed = block.columns.size() + added;
  if (needed > std::size_t(std::numeric_limits<int>::max()))
    throw Error(ExitCode::Input, "the heat matrix of one rank has more than 2^31 entries: use more ranks");
  if (needed <= block.columns.capacity()) return;
  // Sized from the rows so far: doubling would leave up to half of the largest arrays of the program unused.
  const double share = static_cast<double>(rows_) / static_cast<double>(row_ + 1);
  const std::size_t guess = static_cast<std::size_t>(1.03 * static_cast<double>(needed) * std::min(share, 8.0));
  block.columns.reserve(guess);
  block.values.reserve(guess);
}

void HeatMatrixWriter::add_own_row(std::span<const int> columns, std::span<const double> values) {
  if (!fits_) return;
  HeatMatrix::Block &own = matrix_.own, &far = matrix_.far;
  if (fresh_) {
    make_room(own, columns.size());
    own.columns.insert(own.columns.end(), columns.begin(), columns.end());
    own.values.insert(own.values.end(), values.begin(), values.end());
    own.starts.push_back(static_cast<int>(own.columns.size()));
    far.starts.push_back(static_cast<int>(far.columns.size()));
  } else {
    const auto first = own.starts[row_];
    fits_ = far.starts[row_] == far.starts[row_ + 1] &&
            own.starts[row_ + 1] - first == static_cast<int>(columns.size()) &&
            std::equal(columns.begin(), columns.end(), own.columns.begin() + first);
    if (fits_) std::copy(values.begin(), values.end(), own.values.begin() + first);
  }
  row_ += 1;
}

void HeatMatrixWriter::store(HeatMatrix::Block& block, const std::vector<Entry>& entries) {
  if (fresh_) {
    make_room(block, entries.size());
    for (const Entry& entry : entries) {
      block.columns.push_back(static_cast<int>(entry.column));
      block.values.push_back(entry.value);
    }
    block.starts.push_back(static_cast<int>(block.columns.size()));
    return;
  }
  const std::size_t first = block.starts[row_];
  if (block.starts[row_ + 1] - block.starts[row_] != static_cast<int>(entries.size())) {
    fits_ = false;
    return;
  }
  for (std::size_t k = 0; k < entries.size(); ++k) {
    fits_ = fits_ && block.columns[first + k] == entries[k].column;
    block.values[first + k] = entries[k].value;
  }
}

void HeatMatrixWriter::end_row() {
  if (!fits_) return;
  sort_and_merge(own_);
  sort_and_merge(far_);
  store(matrix_.own, own_);
  if (fits_) store(matrix_.far, far_);
  row_ += 1;
}

}  // namespace stirsph
