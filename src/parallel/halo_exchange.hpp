/// Copies of other ranks' particles (and images of one's own) that owned particles need as neighbours.
#pragma once

#include <cstdint>
#include <map>
#include <vector>

#include "base/comm.hpp"
#include "particles/particle_set.hpp"

namespace stirsph {

class CellTable;

/// How a copy looks to those who need it: beyond planes of symmetry or the axis of symmetry (then turned by half a turn
/// about it), or beyond a periodic face.
struct Image {
  Vec3 shift;        ///< m, by coordinates
  int mirrored = 0;  ///< bit d: coordinate d changes its sign before the shift
  bool operator==(const Image&) const = default;
  /// Coordinate d of the image of a particle at x.
  double coordinate(double x, int d) const { return (mirrored >> d & 1 ? -x : x) + shift[d]; }
};

/// What one rank sends to another, or to itself as images.
struct HaloCopies {
  std::vector<std::int32_t> sent;  ///< local indices of owned particles
  std::vector<Image> images;       ///< of each sent copy
};

/// What `own_rank`, which owns `particles`, sends to each rank: every particle within `reach` [m] of a cell where that
/// rank has particles, itself or as an image. Not collective.
std::map<int, HaloCopies> plan_halo(const ParticleSet& particles, const CellTable& cells, double reach, int own_rank);

/// Who sends which particles to whom; rebuilt with the pair list.
class HaloExchange {
 public:
  explicit HaloExchange(Comm comm) : comm_(comm) {}

  /// Makes the plan (plan_halo), resizes the halo of `particles` and fills all fields with a halo role. Collective.
  void build(ParticleSet& particles, const CellTable& cells, double reach);

  /// Refreshes the halo copies of every field with this role. Collective over the ranks that share a border.
  void exchange(ParticleSet& particles, Halo role) const {
    start(particles, role);
    finish(particles, role);
  }
  /// The same in two parts: `start` sends what the owned particles hold now, `finish` waits and fills the copies. Other
  /// roles may be exchanged in between.
  void start(const ParticleSet& particles, Halo role) const;
  void finish(ParticleSet& particles, Halo role) const;

  std::size_t sent() const;
  std::size_t received() const { return received_; }

 private:
  /// What goes to one rank, or to this rank itself as images.
  struct Route {
    int rank;
    std::vector<std::int32_t> sent;  ///< local indices of owned particles
    std::vector<Image> images;       ///< of each sent copy; empty when none is moved
    std::vector<int> reversed;       ///< per image, bit c: velocity component c changes its sign; empty when none does
    std::size_t first_received = 0;  ///< local index of the first copy that comes back from that rank
    std::size_t received = 0;
  };
  /// Persistent messages that carry some fields along the routes, with their buffers. The layout of a buffer is field,
  /// component, particle.
  class Channel {
   public:
    Channel(const Comm& comm, const std::vector<Route>& routes, std::size_t width, int tag);
    ~Channel();
    Channel(const Channel&) = delete;
    Channel& operator=(const Channel&) = delete;

    void start(const std::vector<Route>& routes, const std::vector<const Field*>& fields, const SpaceLayout& layout);
    void finish(ParticleSet& particles, const std::vector<Route>& routes, const std::vector<const Field*>& fields);
    std::size_t width() const { return width_; }

   private:
    int own_rank_;
    std::size_t width_;
    std::vector<std::vector<double>> outboxes_, inboxes_;
    std::vector<MPI_Request> requests_;
  };
  Channel& channel(Halo role, std::size_t width) const;

  Comm comm_;
  std::vector<Route> routes_;
  std::size_t received_ = 0;
  mutable std::map<Halo, Channel> channels_;  ///< made at the first exchange of a role along the present routes
};

}  // namespace stirsph
