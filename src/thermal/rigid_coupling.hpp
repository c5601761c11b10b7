/// Heat links between particles and rigid bodies, and the place of lumped bodies in the matrix.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/comm.hpp"
#include "particles/contact_point.hpp"
#include "particles/particle_set.hpp"
#include "thermal/heat_solver.hpp"

namespace stirsph {

/// Links of this rank's particles to bodies that are not insulated, sorted by particle. The surface resistance per area
/// is
///   R = 1/h_c + max(distance - b dx, 0.05 dx) / k_i;
/// b (lattice_surface_resistance) lets the wall temperature act at the true surface. The lower bound keeps the
/// conductance positive and finite for a particle that has been pushed into the wall: less than 1/20 of a spacing is
/// below what the particles resolve, and a film would only be hidden, not lost, behind it.
class RigidCoupling {
 public:
  struct Link {
    std::int32_t particle;
    std::int32_t body;
    double conductance;  ///< W/K
  };
  struct NodeLink {
    std::int64_t row;  ///< of the particle in the heat matrix
    std::int32_t body;
    double conductance;  ///< W/K
    double temperature;  ///< K of the particle at the start of the step
  };

  /// Decides the rows of the lumped nodes: behind the particles of rank 0, which may have none. Collective.
  RigidCoupling(const Comm& comm, std::span<const RigidHeat> bodies, std::size_t owned);

  /// Reads conductivity and temperature of owned particles and field::matrix_row. Collective: rank 0 receives the links
  /// of the lumped nodes from everybody.
  void update(const Comm& comm, const ParticleSet& particles, std::span<const ContactPoint> contacts,
              std::span<const RigidHeat> bodies, double spacing, double surface_resistance);

  std::size_t local_nodes() const { return local_nodes_; }
  std::size_t rows() const { return owned_ + local_nodes_; }
  std::int64_t first_row() const { return first_row_; }
  /// Row of a lumped body; -1 for the others.
  std::int64_t row_of(std::int32_t body) const { return row_of_body_[body]; }
  /// The lumped bodies, in row order.
  const std::vector<std::int32_t>& nodes() const { return nodes_; }

  std::span<const Link> links(std::size_t particle) const {
    return {links_.data() + starts_[particle], links_.data() + starts_[particle + 1]};
  }
  const std::vector<Link>& links() const { return links_; }
  /// Rank 0 only: every particle's link to this lumped body.
  const std::vector<NodeLink>& node_links(std::int32_t body) const { return node_links_[body]; }

 private:
  std::size_t owned_;
  std::size_t local_nodes_ = 0;
  std::int64_t first_row_ = 0;
  std::vector<std::int64_t> row_of_body_;
  std::vector<std::int32_t> nodes_;
  std::vector<std::size_t> starts_;
  std::vector<Link> links_;
  std::vector<std::vector<NodeLink>> node_links_;
};

}  // namespace stirsph
