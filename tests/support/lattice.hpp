/// A body of particles on a simple cubic (square) lattice, spread over the ranks, with halo copies and pair list ready.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <random>

#include "base/comm.hpp"
#include "neighbours/cluster_order.hpp"
#include "neighbours/pair_list.hpp"
#include "parallel/cell_table.hpp"
#include "parallel/decomposition.hpp"
#include "parallel/domain.hpp"
#include "parallel/halo_exchange.hpp"
#include "particles/field_names.hpp"
#include "particles/particle_set.hpp"

namespace stirsph::testing {

struct Lattice {
  std::array<int, 3> count{1, 1, 1};  ///< particles along x, y, z; z is ignored in two dimensions
  std::array<bool, 3> periodic{};
  double spacing = 1;  ///< m
  double h_over_dx = 1.3;
  double support = 2;  ///< of the kernel, in units of h
  double density = 1;  ///< kg/m3
  double jitter = 0;   ///< each coordinate moves by up to +- jitter * spacing
  int dim = 3;
  bool axisymmetric = false;                  ///< two dimensions r and z; the test makes sections into rings
  std::function<bool(const Vec3&)> inside{};  ///< keeps the particles whose lattice point [m] is inside; all when empty
};

/// The box [0, count * spacing] filled with particles at the cell centres. `add_fields` adds the fields a test needs
/// beyond identity, mass, position, volume and smoothing length. Rank-independent: the same particles with the same
/// ids.
class LatticeBody {
 public:
  template <class AddFields>
  LatticeBody(Comm comm, const Lattice& lattice, AddFields&& add_fields)
      : particles(lattice.axisymmetric ? layout_of<AxisymmetricSwirl>()
                  : lattice.dim == 2   ? layout_of<PlaneStrain>()
                                       : layout_of<Cartesian3>()),
        halo(comm) {
    for (const FieldInfo* info : {&field::id, &field::body, &field::material, &field::mass, &field::position,
                                  &field::volume, &field::smoothing_length})
      particles.add(*info);
    add_fields(particles);

    domain.dim = lattice.dim;
    std::array<int, 3> count = lattice.count;
    if (lattice.dim == 2) count[2] = 1;
    for (int d = 0; d < lattice.dim; ++d) {
      domain.periodic[d] = lattice.periodic[d];
      domain.high[d] = count[d] * lattice.spacing;
    }
    const std::int64_t n = std::int64_t(count[0]) * count[1] * count[2];
    const std::int64_t first = n * comm.rank() / comm.size(), last = n * (comm.rank() + 1) / comm.size();
    particles.resize_owned(static_cast<std::size_t>(last - first));
    const double volume =
        lattice.dim == 2 ? lattice.spacing * lattice.spacing : lattice.spacing * lattice.spacing * lattice.spacing;
    std::size_t kept = 0;
    for (std::int64_t id = first; id < last; ++id) {
      const std::array<std::int64_t, 3> at{id % count[0], id / count[0] % count[1],
                                           id / (std::int64_t(count[0]) * count[1])};
      const Vec3 point{(static_cast<double>(at[0]) + 0.5) * lattice.spacing,
                       (static_cast<double>(at[1]) + 0.5) * lattice.spacing,
                       lattice.dim == 2 ? 0.0 : (static_cast<double>(at[2]) + 0.5) * lattice.spacing};
      if (lattice.inside && !lattice.inside(point)) continue;
      const std::size_t i = kept++;
      std::mt19937_64 random(static_cast<std::uint64_t>(id));  // by id, so that the ranks do not matter
      std::uniform_real_distribution<double> shift(-lattice.jitter, lattice.jitter);
      for (int d = 0; d < lattice.dim; ++d) {
        const double offset = lattice.jitter > 0 ? shift(random) : 0.0;
        particles.component(field::position, d)[i] = (static_cast<double>(at[d]) + 0.5 + offset) * lattice.spacing;
      }
      particles[field::id][i] = static_cast<double>(id);
      particles[field::mass][i] = lattice.density * volume;
      particles[field::volume][i] = volume;
      particles[field::smoothing_length][i] = lattice.h_over_dx * lattice.spacing;
    }
    particles.resize_owned(kept);
    const double reach = lattice.support * lattice.h_over_dx * lattice.spacing * (1 + 1e-9);
    cells =
        std::make_unique<CellTable>(Decomposition(comm).redistribute(particles, domain, reach, comm.size() > 1, {}));
    particles.reorder(cluster_order(particles));
    // Volume is not state: it did not migrate.
    for (std::size_t i = 0; i < particles.owned(); ++i) particles[field::volume][i] = volume;
    halo.build(particles, *cells, reach);
    pairs.build(particles, reach);
  }

  ParticleSet particles;
  Domain domain;
  std::unique_ptr<CellTable> cells;
  HaloExchange halo;
  PairList pairs;
};

}  // namespace stirsph::testing
