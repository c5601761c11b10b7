/// Storage of particle fields: structure of arrays, owned particles first, halo copies behind them. No MPI calls here.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <new>
#include <span>
#include <unordered_map>
#include <vector>

#include "particles/field_info.hpp"
#include "particles/space.hpp"

namespace stirsph {

/// 64-byte aligned storage, so that a vector load of a cluster never straddles a cache line.
template <class T>
struct AlignedAllocator {
  using value_type = T;
  AlignedAllocator() = default;
  template <class U>
  AlignedAllocator(const AlignedAllocator<U>&) {}
  T* allocate(std::size_t n) { return static_cast<T*>(::operator new (n * sizeof(T), std::align_val_t{64})); }
  void deallocate(T* p, std::size_t) { ::operator delete (p, std::align_val_t{64}); }
  template <class U>
  bool operator==(const AlignedAllocator<U>&) const {
    return true;
  }
};
using AlignedVector = std::vector<double, AlignedAllocator<double>>;

/// Particles per cluster: the SIMD sweeps treat this many consecutive, spatially close particles together.
inline constexpr std::size_t cluster_size = 8;

/// A field: its declaration and one array per component.
struct Field {
  const FieldInfo* info;
  std::vector<AlignedVector> components;
};

/// The particles of one rank. Every array has `capacity()` entries: `owned()` of this rank, then halo copies up to
/// `total()`, then padding to a whole cluster (finite values, never used as a result).
class ParticleSet {
 public:
  explicit ParticleSet(SpaceLayout layout) : layout_(layout) {}

  SpaceLayout layout() const { return layout_; }
  std::size_t owned() const { return owned_; }
  std::size_t total() const { return total_; }
  std::size_t capacity() const { return capacity_; }
  std::size_t clusters() const { return (owned_ + cluster_size - 1) / cluster_size; }

  /// Adds a field filled with zeros; adding it twice is allowed and changes nothing.
  /// `length`: of a list.
  void add(const FieldInfo& info, int length = 1);
  bool has(const FieldInfo& info) const { return find(info) != nullptr; }
  const std::vector<std::unique_ptr<Field>>& fields() const { return fields_; }
  int components(Shape shape) const;

  /// The values of a one-component field, halo and padding included. Throws Error(Internal) for an unknown field.
  std::span<double> operator[](const FieldInfo& info) { return component(info, 0); }
  std::span<const double> operator[](const FieldInfo& info) const { return component(info, 0); }
  std::span<double> component(const FieldInfo& info, int c);
  std::span<const double> component(const FieldInfo& info, int c) const;
  /// A vector field's value as a Vec3 in the scene's frame (missing components are zero).
  Vec3 vector_at(const FieldInfo& info, std::size_t i) const;

  /// Sets the number of owned particles; halo copies are dropped, new entries are zero.
  void resize_owned(std::size_t n);
  /// Sets the number of halo copies behind the owned particles, keeping the owned values.
  void resize_halo(std::size_t n);
  /// New order of the owned particles: new[k] = old[order[k]]. Halo copies are dropped; fields that are not state lose
  /// their meaning, as they do in a migration.
  void reorder(const std::vector<std::int32_t>& order);

  /// Doubles per particle over all fields that are state (checkpoint = true): the record that migrates.
  std::size_t state_width() const;
  void pack_state(std::size_t i, double* record) const;
  void unpack_state(std::size_t i, const double* record);

  /// Bytes held by all fields of this set.
  std::size_t bytes() const;

 private:
  Field* find(const FieldInfo& info) const;  ///< by identity: declarations are `inline constexpr`
  void allocate(std::size_t capacity);

  SpaceLayout layout_;
  std::vector<std::unique_ptr<Field>> fields_;
  std::unordered_map<const FieldInfo*, Field*> by_info_;
  std::size_t owned_ = 0, total_ = 0, capacity_ = 0;
};

}  // namespace stirsph
