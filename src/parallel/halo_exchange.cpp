#include "parallel/halo_exchange.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <tuple>

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

/// `own`: also the cells of the own rank; without, only across periodic faces.
std::vector<Destination> destinations_from(const CellTable& cells, std::int64_t key, int own_rank, bool own) {
  std::vector<Destination> result;
  for (const auto& neighbour : cells.around(cells.decode(key)))
    for (const auto& presence : cells.ranks_in(neighbour.key))
      if (presence.rank != own_rank || neighbour.image || own)
        result.push_back({presence.rank, neighbour.shift, neighbour.index});
  return result;
}

/// Bit c: the velocity component c of this image has another sign.
int reversed_components(const Image& image, const Domain& domain, const SpaceLayout& layout) {
  int result = 0;
  for (int d = 0; d < domain.dim; ++d)
    if (image.mirrored >> d & 1)
      result ^= domain.axis && d == 0 ? 0b011 : 1 << layout.axes[d];  // half a turn: r, theta
  return result;
}

/// Bits of the velocity components whose signs multiply that of a field's component: one for a vector, two for the
/// off-diagonal component of a tensor.
int signs_of(Shape shape, int component, const SpaceLayout& layout) {
  switch (shape) {
    case Shape::Velocity:
      return 1 << component;
    case Shape::Position:  // a vector of the space of positions
      return 1 << layout.axes[component];
    case Shape::SymmetricTensor: {
      constexpr std::array<int, 6> signs{0, 0, 0, 0b011, 0b101, 0b110};  // xx yy zz xy xz yz
      return signs[component];
    }
    case Shape::Matrix:  // rows: velocity components, columns: those of a position
      return (1 << component / layout.dim) ^ (1 << layout.axes[component % layout.dim]);
    default:
      return 0;
  }
}

constexpr int first_tag = 11;

std::vector<const Field*> fields_of(const ParticleSet& particles, Halo role) {
  std::vector<const Field*> fields;
  for (const auto& field : particles.fields())
    if (field->info->halo == role) fields.push_back(field.get());
  return fields;
}

std::size_t width_of(const std::vector<const Field*>& fields) {
  std::size_t width = 0;
  for (const Field* field : fields) width += field->components.size();
  return width;
}

}  // namespace

std::map<int, HaloCopies> plan_halo(const ParticleSet& particles, const CellTable& cells, double reach, int own_rank) {
  const Domain& domain = cells.domain();
  constexpr int subsets = 8;  // of the directions in which an image may be mirrored
  std::array<KeyNumbers, subsets> numbers;
  std::array<std::vector<std::vector<Destination>>, subsets> destinations;  // per number
  std::map<int, HaloCopies> plan;
  std::array<const double*, 3> position{};
  for (int d = 0; d < domain.dim; ++d) position[d] = particles.component(field::position, d).data();
  std::vector<std::pair<int, Image>> sent_to;
  for (std::size_t i = 0; i < particles.owned(); ++i) {
    int near = 0;  // directions in which the particle has an image within reach
    for (int d = 0; d < domain.dim; ++d)
      if (domain.mirrors(d) && position[d][i] - domain.plane[d] <= reach) near |= 1 << d;
    sent_to.clear();
    for (int mirrored = 0; mirrored < subsets; ++mirrored) {
      if ((mirrored & near) != mirrored) continue;
      Image image{{}, mirrored};
      for (int d = 0; d < domain.dim; ++d)
        if (mirrored >> d & 1) image.shift[d] = 2 * domain.plane[d];
      Vec3 x;
      for (int d = 0; d < domain.dim; ++d) x[d] = image.coordinate(position[d][i], d);
      const std::int64_t key = cells.key_of(x);
      const std::size_t number = numbers[mirrored].number(key);
      if (number == destinations[mirrored].size())
        destinations[mirrored].push_back(destinations_from(cells, key, own_rank, mirrored != 0));
      for (const Destination& to : destinations[mirrored][number]) {
        if (cells.distance_to_cell(x, to.cell) > reach) continue;
        const std::pair<int, Image> target{to.rank, {image.shift + to.shift, mirrored}};
        if (std::find(sent_to.begin(), sent_to.end(), target) != sent_to.end()) continue;
        sent_to.push_back(target);
        HaloCopies& copies = plan[to.rank];
        copies.sent.push_back(static_cast<std::int32_t>(i));
        copies.images.push_back(target.second);
      }
    }
  }
  return plan;
}

void HaloExchange::build(ParticleSet& particles, const CellTable& cells, double reach) {
  const bool nobody = comm_.size() == 1 && !cells.domain().any_images();
  std::map<int, HaloCopies> plan;
  if (!nobody) plan = plan_halo(particles, cells, reach, comm_.rank());
  bool moved = false;
  for (const auto& [rank, copies] : plan)
    for (const Image& image : copies.images) moved |= image != Image{};

  std::vector<int> send_counts(comm_.size(), 0), receive_counts(comm_.size(), 0);
  for (const auto& [rank, copies] : plan) send_counts[rank] = static_cast<int>(copies.sent.size());
  check_mpi(MPI_Alltoall(send_counts.data(), 1, MPI_INT, receive_counts.data(), 1, MPI_INT, comm_.handle()),
            "MPI_Alltoall");

  channels_.clear();  // they refer to the routes
  routes_.clear();
  received_ = 0;
  for (int rank = 0; rank < comm_.size(); ++rank) {
    if (send_counts[rank] == 0 && receive_counts[rank] == 0) continue;
    Route route;
    route.rank = rank;
    route.sent = std::move(plan[rank].sent);
    if (moved) route.images = std::move(plan[rank].images);
    const Domain& domain = cells.domain();
    if (domain.axis || domain.any_symmetric())
      for (const Image& image : route.images)
        route.reversed.push_back(reversed_components(image, domain, particles.layout()));
    route.first_received = particles.owned() + received_;
    route.received = receive_counts[rank];
    received_ += route.received;
    routes_.push_back(std::move(route));
  }
  particles.resize_halo(received_);

  std::vector<const Field*> all;
  for (const auto& field : particles.fields())
    if (field->info->halo != Halo::None) all.push_back(field.get());
  Channel once(comm_, routes_, width_of(all), first_tag);
  once.start(routes_, all, particles.layout());
  once.finish(particles, routes_, all);
}

HaloExchange::Channel::Channel(const Comm& comm, const std::vector<Route>& routes, std::size_t width, int tag)
    : own_rank_(comm.rank()), width_(width), outboxes_(routes.size()), inboxes_(routes.size()) {
  for (std::size_t k = 0; k < routes.size(); ++k) {
    const Route& route = routes[k];
    outboxes_[k].resize(route.sent.size() * width);
    inboxes_[k].resize(route.received * width);
    if (route.rank == own_rank_) continue;
    if (!inboxes_[k].empty())
      check_mpi(MPI_Recv_init(inboxes_[k].data(), static_cast<int>(inboxes_[k].size()), MPI_DOUBLE, route.rank, tag,
                              comm.handle(), &requests_.emplace_back()),
                "MPI_Recv_init");
    if (!outboxes_[k].empty())
      check_mpi(MPI_Send_init(outboxes_[k].data(), static_cast<int>(outboxes_[k].size()), MPI_DOUBLE, route.rank, tag,
                              comm.handle(), &requests_.emplace_back()),
                "MPI_Send_init");
  }
}

HaloExchange::Channel::~Channel() {
  for (MPI_Request& request : requests_) MPI_Request_free(&request);
}

void HaloExchange::Channel::start(const std::vector<Route>& routes, const std::vector<const Field*>& fields,
                                  const SpaceLayout& layout) {
  for (std::size_t k = 0; k < routes.size(); ++k) {
    const Route& route = routes[k];
    double* write = (route.rank == own_rank_ ? inboxes_ : outboxes_)[k].data();
    for (const Field* field : fields) {
      const bool is_position = field->info->name == field::position.name && !route.images.empty();
      for (std::size_t c = 0; c < field->components.size(); ++c) {
        const AlignedVector& values = field->components[c];
        const int component = static_cast<int>(c);
        if (is_position)
          for (std::size_t s = 0; s < route.sent.size(); ++s)
            *write++ = route.images[s].coordinate(values[route.sent[s]], component);
        else if (const int signs = signs_of(field->info->shape, component, layout); signs && !route.reversed.empty())
          for (std::size_t s = 0; s < route.sent.size(); ++s) {
            const double value = values[route.sent[s]];
            *write++ = std::popcount(static_cast<unsigned>(route.reversed[s] & signs)) % 2 ? -value : value;
          }
        else
          for (const std::int32_t i : route.sent) *write++ = values[i];
      }
    }
  }
  if (!requests_.empty()) check_mpi(MPI_Startall(static_cast<int>(requests_.size()), requests_.data()), "MPI_Startall");
}

void HaloExchange::Channel::finish(ParticleSet& particles, const std::vector<Route>& routes,
                                   const std::vector<const Field*>& fields) {
  check_mpi(MPI_Waitall(static_cast<int>(requests_.size()), requests_.data(), MPI_STATUSES_IGNORE), "MPI_Waitall");
  for (std::size_t k = 0; k < routes.size(); ++k) {
    const Route& route = routes[k];
    const double* read = inboxes_[k].data();
    for (const Field* field : fields)
      for (std::size_t c = 0; c < field->components.size(); ++c) {
        auto values = particles.component(*field->info, static_cast<int>(c));
        std::copy(read, read + route.received, values.begin() + route.first_received);
        read += route.received;
      }
  }
}

HaloExchange::Channel& HaloExchange::channel(Halo role, std::size_t width) const {
  auto found = channels_.find(role);
  if (found != channels_.end() && found->second.width() != width) {  // a field of this role was added since
    channels_.erase(found);
    found = channels_.end();
  }
  if (found == channels_.end())
    found = channels_
                .emplace(std::piecewise_construct, std::forward_as_tuple(role),
                         std::forward_as_tuple(comm_, routes_, width, first_tag + 1 + static_cast<int>(role)))
                .first;
  return found->second;
}

void HaloExchange::start(const ParticleSet& particles, Halo role) const {
  if (routes_.empty()) return;
  const std::vector<const Field*> fields = fields_of(particles, role);
  channel(role, width_of(fields)).start(routes_, fields, particles.layout());
}

void HaloExchange::finish(ParticleSet& particles, Halo role) const {
  if (routes_.empty()) return;
  const std::vector<const Field*> fields = fields_of(particles, role);
  channel(role, width_of(fields)).finish(particles, routes_, fields);
}

std::size_t HaloExchange::sent() const {
  std::size_t sum = 0;
  for (const Route& route : routes_) sum += route.sent.size();
  return sum;
}

}  // namespace stirsph
