#include "parallel/halo_exchange.hpp"

#include <algorithm>
#include <array>

#include "parallel/cell_table.hpp"
#include "particles/field_names.hpp"

namespace stirsph {
namespace {

/// A rank that has particles in a neighbouring cell, and how one's particle looks from there.
struct Destination {
  int rank;
  Vec3 shift;
  CellIndex cell;  ///< the neighbouring cell in the frame of the sending particle
};

std::vector<Destination> destinations_from(const CellTable& cells, std::int64_t key, int own_rank) {
  std::vector<Destination> result;
  for (const auto& neighbour : cells.around(cells.decode(key)))
    for (const auto& presence : cells.ranks_in(neighbour.key))
      if (presence.rank != own_rank || neighbour.image)
        result.push_back({presence.rank, neighbour.shift, neighbour.index});
  return result;
}

}  // namespace

std::map<int, HaloCopies> plan_halo(const ParticleSet& particles, const CellTable& cells, double reach, int own_rank) {
  KeyNumbers numbers;
  std::vector<std::vector<Destination>> destinations;  // per number
  std::map<int, HaloCopies> plan;
  std::array<const double*, 3> position{};
  for (int d = 0; d < cells.domain().dim; ++d) position[d] = particles.component(field::position, d).data();
  std::vector<std::pair<int, Vec3>> sent_to;
  for (std::size_t i = 0; i < particles.owned(); ++i) {
    Vec3 x;
    for (int d = 0; d < cells.domain().dim; ++d) x[d] = position[d][i];
    const std::int64_t key = cells.key_of(x);
    const std::size_t number = numbers.number(key);
    if (number == destinations.size()) destinations.push_back(destinations_from(cells, key, own_rank));
    sent_to.clear();
    for (const Destination& to : destinations[number]) {
      if (cells.distance_to_cell(x, to.cell) > reach) continue;
      const std::pair<int, Vec3> target{to.rank, to.shift};
      if (std::find(sent_to.begin(), sent_to.end(), target) != sent_to.end()) continue;
      sent_to.push_back(target);
      HaloCopies& copies = plan[to.rank];
      copies.sent.push_back(static_cast<std::int32_t>(i));
      copies.shifts.push_back(to.shift);
    }
  }
  return plan;
}

void HaloExchange::build(ParticleSet& particles, const CellTable& cells, double reach) {
  const bool nobody = comm_.size() == 1 && !cells.domain().any_periodic();
  std::map<int, HaloCopies> plan;
  if (!nobody) plan = plan_halo(particles, cells, reach, comm_.rank());
  bool shifted = false;
  for (const auto& [rank, copies] : plan)
    for (const Vec3& shift : copies.shifts) shifted |= shift != Vec3{};

  std::vector<int> send_counts(comm_.size(), 0), receive_counts(comm_.size(), 0);
  for (const auto& [rank, copies] : plan) send_counts[rank] = static_cast<int>(copies.sent.size());
  check_mpi(MPI_Alltoall(send_counts.data(), 1, MPI_INT, receive_counts.data(), 1, MPI_INT, comm_.handle()),
            "MPI_Alltoall");

  routes_.clear();
  received_ = 0;
  for (int rank = 0; rank < comm_.size(); ++rank) {
    if (send_counts[rank] == 0 && receive_counts[rank] == 0) continue;
    Route route;
    route.rank = rank;
    route.sent = std::move(plan[rank].sent);
    if (shifted) route.shifts = std::move(plan[rank].shifts);
    route.first_received = particles.owned() + received_;
    route.received = receive_counts[rank];
    received_ += route.received;
    routes_.push_back(std::move(route));
  }
  particles.resize_halo(received_);

  std::vector<const Field*> all;
  for (const auto& field : particles.fields())
    if (field->info->halo != Halo::None) all.push_back(field.get());
  exchange_fields(particles, all);
}

void HaloExchange::exchange(ParticleSet& particles, Halo role) const {
  std::vector<const Field*> fields;
  for (const auto& field : particles.fields())
    if (field->info->halo == role) fields.push_back(field.get());
  exchange_fields(particles, fields);
}

void HaloExchange::exchange_fields(ParticleSet& particles, const std::vector<const Field*>& fields) const {
  std::size_t width = 0;
  for (const Field* field : fields) width += field->components.size();
  if (width == 0 || routes_.empty()) return;

  constexpr int tag = 11;
  std::vector<std::vector<double>> outboxes(routes_.size()), inboxes(routes_.size());
  std::vector<MPI_Request> requests;
  for (std::size_t k = 0; k < routes_.size(); ++k) {
    const Route& route = routes_[k];
    if (route.rank == comm_.rank() || route.received == 0) continue;
    inboxes[k].resize(route.received * width);
    check_mpi(MPI_Irecv(inboxes[k].data(), static_cast<int>(inboxes[k].size()), MPI_DOUBLE, route.rank, tag,
                        comm_.handle(), &requests.emplace_back()),
              "MPI_Irecv");
  }
  for (std::size_t k = 0; k < routes_.size(); ++k) {
    const Route& route = routes_[k];
    auto& outbox = outboxes[k];
    outbox.resize(route.sent.size() * width);
    double* write = outbox.data();
    for (const Field* field : fields) {
      const bool is_position = field->info->name == field::position.name && !route.shifts.empty();
      for (std::size_t c = 0; c < field->components.size(); ++c) {
        const AlignedVector& values = field->components[c];
        if (is_position)
          for (std::size_t s = 0; s < route.sent.size(); ++s)
            *write++ = values[route.sent[s]] + route.shifts[s][static_cast<int>(c)];
        else
          for (const std::int32_t i : route.sent) *write++ = values[i];
      }
    }
    if (route.rank == comm_.rank())
      inboxes[k] = std::move(outbox);
    else if (!route.sent.empty())
      check_mpi(MPI_Isend(outbox.data(), static_cast<int>(outbox.size()), MPI_DOUBLE, route.rank, tag, comm_.handle(),
                          &requests.emplace_back()),
                "MPI_Isend");
  }
  check_mpi(MPI_Waitall(static_cast<int>(requests.size()), requests.data(), MPI_STATUSES_IGNORE), "MPI_Waitall");
  for (std::size_t k = 0; k < routes_.size(); ++k) {
    const Route& route = routes_[k];
    const double* read = inboxes[k].data();
    for (const Field* field : fields)
      for (std::size_t c = 0; c < field->components.size(); ++c) {
        auto values = particles.component(*field->info, static_cast<int>(c));
        std::copy(read, read + route.received, values.begin() + route.first_received);
        read += route.received;
      }
  }
}

std::size_t HaloExchange::sent() const {
  std::size_t sum = 0;
  for (const Route& route : routes_) sum += route.sent.size();
  return sum;
}

}  // namespace stirsph
