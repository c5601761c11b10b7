#include "thermal/rigid_coupling.hpp"

#include <algorithm>
#include <cmath>

#include "particles/field_names.hpp"

namespace stirsph {

RigidCoupling::RigidCoupling(const Comm& comm, std::span<const RigidHeat> bodies, std::size_t owned) : owned_(owned) {
  for (std::size_t b = 0; b < bodies.size(); ++b)
    if (bodies[b].role == RigidHeat::Role::LumpedNode) nodes_.push_back(static_cast<std::int32_t>(b));
  if (comm.is_root()) local_nodes_ = nodes_.size();
  first_row_ = comm.exclusive_sum(static_cast<std::int64_t>(owned_ + local_nodes_));
  const std::int64_t owned_by_root = comm.sum(comm.is_root() ? static_cast<std::int64_t>(owned_) : 0);
  row_of_body_.assign(bodies.size(), -1);
  for (std::size_t n = 0; n < nodes_.size(); ++n) row_of_body_[nodes_[n]] = owned_by_root + static_cast<int>(n);
}

void RigidCoupling::update(const Comm& comm, const ParticleSet& particles, std::span<const ContactPoint> contacts,
                           std::span<const RigidHeat> bodies, double spacing, double surface_resistance) {
  const auto conductivity = particles[field::conductivity];
  const auto temperature = particles[field::temperature];
  const auto row = particles[field::matrix_row];
  links_.clear();
  for (const ContactPoint& contact : contacts) {
    const RigidHeat& body = bodies[contact.body];
    STIRSPH_EXPECT(contact.particle >= 0 && std::size_t(contact.particle) < owned_, "contacts are of owned particles");
    const double k = conductivity[contact.particle], film = body.interface_conductance;
    if (body.role == RigidHeat::Role::Insulated || !(k > 0) || !(film > 0) || !(contact.area > 0)) continue;
    const double depth = std::max(contact.distance - surface_resistance * spacing, 0.05 * spacing);
    const double resistance = (std::isinf(film) ? 0.0 : 1 / film) + depth / k;
    links_.push_back({contact.particle, contact.body, contact.area / resistance});
  }
  std::stable_sort(links_.begin(), links_.end(), [](const Link& a, const Link& b) { return a.particle < b.particle; });
  starts_.assign(owned_ + 1, 0);
  for (const Link& link : links_) starts_[link.particle + 1] += 1;
  for (std::size_t i = 0; i < owned_; ++i) starts_[i + 1] += starts_[i];

  node_links_.assign(bodies.size(), {});
  if (nodes_.empty()) return;
  std::vector<double> records;
  for (const Link& link : links_)
    if (row_of_body_[link.body] >= 0)
      records.insert(records.end(),
                     {row[link.particle], double(link.body), link.conductance, temperature[link.particle]});
  records = comm.gather(records);
  for (std::size_t k = 0; k + 3 < records.size(); k += 4) {
    const auto body = static_cast<std::int32_t>(records[k + 1]);
    node_links_[body].push_back({static_cast<std::int64_t>(records[k]), body, records[k + 2], records[k + 3]});
  }
}

}  // namespace stirsph
