#include "particles/particle_set.hpp"

#include <algorithm>
#include <string>

#include "base/error.hpp"

namespace stirsph {

int ParticleSet::components(Shape shape) const {
  switch (shape) {
    case Shape::Scalar:
      return 1;
    case Shape::Position:
      return layout_.dim;
    case Shape::Velocity:
      return layout_.velocity_components;
    case Shape::SymmetricTensor:
      return layout_.stress_components;
    case Shape::Matrix:
      return layout_.velocity_components * layout_.dim;
    case Shape::List:
      return 1;
  }
  return 1;
}

Field* ParticleSet::find(const FieldInfo& info) const {
  const auto found = by_info_.find(&info);
  return found == by_info_.end() ? nullptr : found->second;
}

void ParticleSet::add(const FieldInfo& info, int length) {
  if (find(info)) return;
  auto field = std::make_unique<Field>();
  field->info = &info;
  const int count = info.shape == Shape::List ? length : components(info.shape);
  field->components.assign(count, AlignedVector(capacity_, 0.0));
  by_info_[&info] = field.get();
  fields_.push_back(std::move(field));
}

std::span<double> ParticleSet::component(const FieldInfo& info, int c) {
  Field* field = find(info);
  if (!field) throw Error(ExitCode::Internal, "no module asked for the field " + std::string(info.name));
  return field->components[c];
}

std::span<const double> ParticleSet::component(const FieldInfo& info, int c) const {
  const Field* field = find(info);
  if (!field) throw Error(ExitCode::Internal, "no module asked for the field " + std::string(info.name));
  return field->components[c];
}

Vec3 ParticleSet::vector_at(const FieldInfo& info, std::size_t i) const {
  const Field* field = find(info);
  if (!field) throw Error(ExitCode::Internal, "no module asked for the field " + std::string(info.name));
  Vec3 v;
  for (std::size_t c = 0; c < field->components.size() && c < 3; ++c)
    v[info.shape == Shape::Position ? layout_.axes[c] : static_cast<int>(c)] = field->components[c][i];
  return v;
}

void ParticleSet::allocate(std::size_t total) {
  total_ = total;
  const std::size_t padded = (total + cluster_size - 1) / cluster_size * cluster_size;
  for (auto& field : fields_)
    for (auto& values : field->components) {
      if (values.capacity() < padded) values.reserve(padded + padded / 32);  // resize alone would double it
      values.resize(padded, 0.0);
    }
  capacity_ = padded;
}

void ParticleSet::resize_owned(std::size_t n) {
  for (auto& field : fields_)
    for (auto& values : field->components) values.resize(std::min(owned_, n));
  owned_ = n;
  allocate(n);
}

void ParticleSet::resize_halo(std::size_t n) { allocate(owned_ + n); }

void ParticleSet::reorder(const std::vector<std::int32_t>& order) {
  STIRSPH_EXPECT(order.size() == owned_, "an order names every owned particle once");
  AlignedVector moved;
  moved.reserve(capacity_);
  for (auto& field : fields_) {
    if (!field->info->checkpoint) continue;
    for (auto& values : field->components) {
      moved.resize(order.size());
      for (std::size_t k = 0; k < order.size(); ++k) moved[k] = values[order[k]];
      std::swap(moved, values);
    }
  }
  allocate(owned_);
}

std::size_t ParticleSet::state_width() const {
  std::size_t width = 0;
  for (const auto& field : fields_)
    if (field->info->checkpoint) width += field->components.size();
  return width;
}

void ParticleSet::pack_state(std::size_t i, double* record) const {
  for (const auto& field : fields_)
    if (field->info->checkpoint)
      for (const auto& values : field->components) *record++ = values[i];
}

void ParticleSet::unpack_state(std::size_t i, const double* record) {
  for (auto& field : fields_)
    if (field->info->checkpoint)
      for (auto& values : field->components) values[i] = *record++;
}

std::size_t ParticleSet::bytes() const {
  std::size_t sum = 0;
  for (const auto& field : fields_)
    for (const auto& values : field->components) sum += values.capacity() * sizeof(double);
  return sum;
}

}  // namespace stirsph
