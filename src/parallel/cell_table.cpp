#include "parallel/cell_table.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "particles/field_names.hpp"

namespace stirsph {
namespace {
constexpr int key_bits = 21;
constexpr std::int64_t key_offset = std::int64_t(1) << (key_bits - 1);
}  // namespace

CellTable::CellTable(const Comm& comm, const ParticleSet& particles, const Domain& domain, double reach,
                     std::span<const double> weights)
    : domain_(domain) {
  for (int d = 0; d < domain.dim; ++d) {
    size_[d] = reach;
    spread_[d] = 1;
    if (!domain.periodic[d]) continue;
    period_[d] = std::max<std::int64_t>(1, static_cast<std::int64_t>(std::floor(domain.length(d) / reach)));
    size_[d] = domain.length(d) / static_cast<double>(period_[d]);
    spread_[d] = static_cast<std::int64_t>(std::ceil(reach / size_[d] - 1e-9));
  }
  particle_cells_.resize(particles.owned());
  KeyNumbers numbers;
  std::vector<double> local;  // weight per cell of this rank
  comm.together([&] {
    std::array<const double*, 3> position{};
    for (int d = 0; d < domain.dim; ++d) position[d] = particles.component(field::position, d).data();
    for (std::size_t i = 0; i < particles.owned(); ++i) {
      Vec3 x;
      for (int d = 0; d < domain.dim; ++d) x[d] = position[d][i];
      for (int d = 0; d < domain.dim; ++d)
        if (!std::isfinite(x[d]) || std::abs(x[d]) > size_[d] * static_cast<double>(key_offset - 4))
          throw BlowUp(
              "particle " + std::to_string(static_cast<std::int64_t>(particles[field::id][i])) +
              " is lost: its position is (" + std::to_string(x.x) + ", " + std::to_string(x.y) + ", " +
              std::to_string(x.z) +
              ") m. Reduce the time step (time.cfl) or the mass scaling, or check contact and initial overlap.");
      particle_cells_[i] = numbers.number(key_of(x));
      local.resize(numbers.keys().size());
      local[particle_cells_[i]] += weights.empty() ? 1.0 : weights[i];
    }
  });
  std::vector<std::int64_t> packed;  // key and bits of the weight, side by side in one message
  packed.reserve(2 * local.size());
  for (std::size_t c = 0; c < local.size(); ++c) {
    packed.push_back(numbers.keys()[c]);
    packed.push_back(std::bit_cast<std::int64_t>(local[c]));
  }
  const std::vector<std::int64_t> sizes = comm.all_gather(std::vector<std::int64_t>{std::int64_t(packed.size())});
  const std::vector<std::int64_t> all = comm.all_gather(packed);
  entries_.reserve(all.size() / 2);
  std::size_t at = 0;
  for (int rank = 0; rank < comm.size(); ++rank)
    for (const std::size_t end = at + sizes[rank]; at < end; at += 2)
      entries_.push_back({all[at], rank, std::bit_cast<double>(all[at + 1])});
  std::sort(entries_.begin(), entries_.end(),
            [](const Presence& a, const Presence& b) { return a.key != b.key ? a.key < b.key : a.rank < b.rank; });
  for (const Presence& entry : entries_)
    if (keys_.empty() || keys_.back() != entry.key) keys_.push_back(entry.key);

  std::vector<std::int32_t> place;  // of a local cell in keys_
  for (const std::int64_t key : numbers.keys())
    place.push_back(static_cast<std::int32_t>(std::lower_bound(keys_.begin(), keys_.end(), key) - keys_.begin()));
  for (std::int32_t& cell : particle_cells_) cell = place[cell];
}

CellIndex CellTable::index_of(const Vec3& position) const {
  CellIndex cell{};
  for (int d = 0; d < domain_.dim; ++d) {
    const double origin = domain_.periodic[d] ? domain_.low[d] : 0.0;
    cell[d] = static_cast<std::int64_t>(std::floor((position[d] - origin) / size_[d]));
    if (period_[d]) cell[d] = std::clamp<std::int64_t>(cell[d], 0, period_[d] - 1);
  }
  return cell;
}

std::int64_t CellTable::encode(const CellIndex& cell) const {
  return ((cell[2] + key_offset) << (2 * key_bits)) | ((cell[1] + key_offset) << key_bits) | (cell[0] + key_offset);
}

CellIndex CellTable::decode(std::int64_t key) const {
  constexpr std::int64_t mask = (std::int64_t(1) << key_bits) - 1;
  return {(key & mask) - key_offset, ((key >> key_bits) & mask) - key_offset, (key >> (2 * key_bits)) - key_offset};
}

std::int64_t CellTable::key_of(const Vec3& position) const { return encode(index_of(position)); }

std::span<const CellTable::Presence> CellTable::ranks_in(std::int64_t key) const {
  const auto first = std::lower_bound(entries_.begin(), entries_.end(), key,
                                      [](const Presence& entry, std::int64_t k) { return entry.key < k; });
  auto last = first;
  while (last != entries_.end() && last->key == key) ++last;
  return {first, last};
}

std::vector<CellTable::Neighbour> CellTable::around(const CellIndex& cell) const {
  std::vector<Neighbour> result;
  for (std::int64_t dz = -spread_[2]; dz <= spread_[2]; ++dz)
    for (std::int64_t dy = -spread_[1]; dy <= spread_[1]; ++dy)
      for (std::int64_t dx = -spread_[0]; dx <= spread_[0]; ++dx) {
        const CellIndex unwrapped{cell[0] + dx, cell[1] + dy, cell[2] + dz};
        CellIndex wrapped = unwrapped;
        Neighbour neighbour{0, {}, unwrapped, false};
        for (int d = 0; d < domain_.dim; ++d) {
          if (!period_[d]) continue;
          const std::int64_t turns =
              unwrapped[d] >= 0 ? unwrapped[d] / period_[d] : -((-unwrapped[d] + period_[d] - 1) / period_[d]);
          wrapped[d] = unwrapped[d] - turns * period_[d];
          // Seen from the wrapped cell, the asking particle appears moved back by the turns.
          neighbour.shift[d] = -static_cast<double>(turns) * domain_.length(d);
          if (turns != 0) neighbour.image = true;
        }
        neighbour.key = encode(wrapped);
        result.push_back(neighbour);
      }
  return result;
}

double CellTable::distance_to_cell(const Vec3& point, const CellIndex& cell) const {
  double sum = 0;
  for (int d = 0; d < domain_.dim; ++d) {
    const double origin = domain_.periodic[d] ? domain_.low[d] : 0.0;
    const double low = origin + static_cast<double>(cell[d]) * size_[d], high = low + size_[d];
    const double gap = std::max({low - point[d], point[d] - high, 0.0});
    sum += gap * gap;
  }
  return std::sqrt(sum);
}

void CellTable::set_owners(const std::vector<int>& owners) {
  std::vector<Presence> merged;
  merged.reserve(keys_.size());
  std::size_t at = 0;
  for (std::size_t k = 0; k < keys_.size(); ++k) {
    double weight = 0;
    for (; at < entries_.size() && entries_[at].key == keys_[k]; ++at) weight += entries_[at].weight;
    merged.push_back({keys_[k], owners[k], weight});
  }
  entries_ = std::move(merged);
}

std::size_t KeyNumbers::start_of(std::int64_t key) const {
  // Fibonacci hashing: the high bits of the product depend on all bits of the key.
  const std::uint64_t mixed = static_cast<std::uint64_t>(key) * 0x9e3779b97f4a7c15u;
  return static_cast<std::size_t>(mixed >> 32) & (table_.size() - 1);
}

void KeyNumbers::grow() {
  table_.assign(std::max<std::size_t>(1024, 2 * table_.size()), -1);
  for (std::size_t k = 0; k < keys_.size(); ++k) {
    std::size_t slot = start_of(keys_[k]);
    while (table_[slot] >= 0) slot = (slot + 1) & (table_.size() - 1);
    table_[slot] = static_cast<std::int32_t>(k);
  }
}

std::int32_t KeyNumbers::number(std::int64_t key) {
  if (last_ >= 0 && keys_[last_] == key) return last_;
  if (2 * keys_.size() >= table_.size()) grow();
  std::size_t slot = start_of(key);
  while (table_[slot] >= 0 && keys_[table_[slot]] != key) slot = (slot + 1) & (table_.size() - 1);
  if (table_[slot] < 0) {
    table_[slot] = static_cast<std::int32_t>(keys_.size());
    keys_.push_back(key);
  }
  return last_ = table_[slot];
}

}  // namespace stirsph
