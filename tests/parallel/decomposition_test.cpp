/// Migration, halo copies and the balance of the decomposition, on any number of ranks.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <map>
#include <numeric>
#include <random>
#include <vector>

#include "neighbours/cluster_order.hpp"
#include "neighbours/pair_list.hpp"
#include "parallel/cell_table.hpp"
#include "parallel/decomposition.hpp"
#include "parallel/halo_exchange.hpp"
#include "particles/field_names.hpp"

namespace stirsph {
namespace {

constexpr double reach = 2.6;  // m; particles are about 1 m apart

/// All shapes of fields, state and not state, with every halo role.
const std::vector<const FieldInfo*>& fields() {
  static const std::vector<const FieldInfo*> list{&field::id,
                                                  &field::body,
                                                  &field::material,
                                                  &field::sets,
                                                  &field::mass,
                                                  &field::position,
                                                  &field::velocity,
                                                  &field::volumetric_strain,
                                                  &field::volume,
                                                  &field::smoothing_length,
                                                  &field::stress,
                                                  &field::flow_stress,
                                                  &field::stress_deviator,
                                                  &field::temperature,
                                                  &field::heat_input,
                                                  &field::conductivity};
  return list;
}

/// What component c of the field number f holds for a particle: a number of its own, unlike any other.
double signature(double id, std::size_t f, int c) { return std::sin(1 + id * 31.7 + double(f) * 5.3 + c * 1.9); }

/// Everything but identity and position carries its signature.
void fill(ParticleSet& p) {
  for (std::size_t f = 0; f < fields().size(); ++f) {
    if (fields()[f] == &field::id || fields()[f] == &field::position) continue;
    for (int c = 0; c < p.components(fields()[f]->shape); ++c)
      for (std::size_t i = 0; i < p.owned(); ++i) p.component(*fields()[f], c)[i] = signature(p[field::id][i], f, c);
  }
}

/// Particles 0..n-1 placed by `place(id)`; all of them begin on the ranks `first_owner(id)` names.
template <class Place, class FirstOwner>
ParticleSet make_particles(int dim, int n, Place&& place, FirstOwner&& first_owner) {
  ParticleSet p(dim == 2 ? layout_of<PlaneStrain>() : layout_of<Cartesian3>());
  for (const FieldInfo* info : fields()) p.add(*info);
  std::vector<int> own;
  for (int id = 0; id < n; ++id)
    if (first_owner(id) == Comm().rank()) own.push_back(id);
  p.resize_owned(own.size());
  for (std::size_t i = 0; i < own.size(); ++i) {
    p[field::id][i] = own[i];
    const Vec3 x = place(own[i]);
    for (int d = 0; d < dim; ++d) p.component(field::position, d)[i] = x[d];
  }
  fill(p);
  return p;
}

/// Every id once over all ranks, and every state field as it was. Position is compared where `place` is given
/// unwrapped.
template <class Place>
void expect_nothing_lost(const ParticleSet& p, int n, const Domain& domain, Place&& place) {
  const Comm comm;
  const auto ids = p[field::id].first(p.owned());
  std::vector<double> all = comm.all_gather(std::vector<double>(ids.begin(), ids.end()));
  std::sort(all.begin(), all.end());
  ASSERT_EQ(all.size(), static_cast<std::size_t>(n)) << "particles lost or doubled";
  for (int id = 0; id < n; ++id) ASSERT_EQ(all[id], id) << "particles lost or doubled";
  for (std::size_t i = 0; i < p.owned(); ++i) {
    for (std::size_t f = 0; f < fields().size(); ++f) {
      if (!fields()[f]->checkpoint || fields()[f] == &field::id || fields()[f] == &field::position) continue;
      for (int c = 0; c < p.components(fields()[f]->shape); ++c)
        ASSERT_EQ(p.component(*fields()[f], c)[i], signature(p[field::id][i], f, c))
            << fields()[f]->name << " of particle " << p[field::id][i];
    }
    const Vec3 expected = place(static_cast<int>(p[field::id][i]));
    for (int d = 0; d < domain.dim; ++d)
      ASSERT_NEAR(p.component(field::position, d)[i], domain.wrap(expected[d], d), 1e-12);
  }
}

/// Each halo copy holds its owner's values and lies at the owner's position or an image of it; no copy comes twice,
/// none is a plain copy of an own particle; and whatever lies within reach of an owned particle is there.
void expect_halo_complete(const ParticleSet& p, const Domain& domain) {
  const Comm comm;
  const int dim = domain.dim;
  std::vector<double> local;
  for (std::size_t i = 0; i < p.owned(); ++i) {
    local.push_back(p[field::id][i]);
    for (int d = 0; d < 3; ++d) local.push_back(d < dim ? p.component(field::position, d)[i] : 0.0);
  }
  const std::vector<double> all = comm.all_gather(local);
  std::map<long, Vec3> owner;
  for (std::size_t k = 0; k < all.size(); k += 4) owner[std::lround(all[k])] = {all[k + 1], all[k + 2], all[k + 3]};

  using Image = std::pair<long, std::array<long, 3>>;  // id and periodic shift in box lengths
  std::map<Image, int> present;
  for (std::size_t i = 0; i < p.total(); ++i) {
    const long id = std::lround(p[field::id][i]);
    const Vec3 shift = p.vector_at(field::position, i) - owner.at(id);
    Image image{id, {}};
    for (int d = 0; d < dim; ++d) {
      if (domain.periodic[d]) image.second[d] = std::lround(shift[d] / domain.length(d));
      ASSERT_NEAR(shift[d], domain.periodic[d] ? image.second[d] * domain.length(d) : 0.0, 1e-12);
    }
    present[image] += 1;
    if (i < p.owned()) continue;
    for (std::size_t f = 0; f < fields().size(); ++f) {
      if (fields()[f]->halo == Halo::None || fields()[f] == &field::id || fields()[f] == &field::position) continue;
      for (int c = 0; c < p.components(fields()[f]->shape); ++c)
        ASSERT_EQ(p.component(*fields()[f], c)[i], signature(p[field::id][i], f, c)) << fields()[f]->name;
    }
  }
  for (const auto& [image, times] : present) EXPECT_EQ(times, 1) << "particle " << image.first << " comes twice";

  std::array<int, 3> images{};
  for (int d = 0; d < dim; ++d)
    if (domain.periodic[d]) images[d] = static_cast<int>(std::ceil(reach / domain.length(d))) + 1;
  long missing = 0;
  for (const auto& [id, x] : owner)
    for (int a = -images[0]; a <= images[0]; ++a)
      for (int b = -images[1]; b <= images[1]; ++b)
        for (int c = -images[2]; c <= images[2]; ++c) {
          const std::array<int, 3> turns{a, b, c};
          Vec3 seen = x;
          for (int d = 0; d < dim; ++d)
            if (domain.periodic[d]) seen[d] += turns[d] * domain.length(d);
          if (present.count({id, {a, b, c}})) continue;
          for (std::size_t i = 0; i < p.owned(); ++i)
            if (norm(p.vector_at(field::position, i) - seen) < reach * (1 - 1e-9)) {
              missing += 1;
              break;
            }
        }
  EXPECT_EQ(missing, 0) << "images within reach that the halo lacks";
}

/// Redistributes, orders, builds the halo and checks all of it; then moves the values and checks the exchange.
template <class Place, class FirstOwner>
ParticleSet run(const Domain& domain, int n, Place&& place, FirstOwner&& first_owner, bool repartition = true) {
  const Comm comm;
  ParticleSet p = make_particles(domain.dim, n, place, first_owner);
  const CellTable cells = Decomposition(comm).redistribute(p, domain, reach, repartition, {});
  expect_nothing_lost(p, n, domain, place);
  fill(p);  // fields that are not state
  p.reorder(cluster_order(p));
  fill(p);
  HaloExchange halo(comm);
  halo.build(p, cells, reach);
  expect_halo_complete(p, domain);
  // Exchange by role: spoil the copies, refresh, compare again.
  for (std::size_t f = 0; f < fields().size(); ++f)
    if (fields()[f]->halo != Halo::None)
      for (int c = 0; c < p.components(fields()[f]->shape); ++c) {
        auto values = p.component(*fields()[f], c);
        std::fill(values.begin() + p.owned(), values.begin() + p.total(), std::numeric_limits<double>::quiet_NaN());
      }
  for (Halo role : {Halo::Static, Halo::Kinematic, Halo::Stress, Halo::Thermal}) halo.exchange(p, role);
  expect_halo_complete(p, domain);
  return p;
}

Vec3 on_lattice(int id, int nx, int ny) { return {id % nx + 0.5, id / nx % ny + 0.5, id / (nx * ny) + 0.5}; }
int scattered(int id) { return static_cast<int>((id * 2654435761u >> 8) % static_cast<unsigned>(Comm().size())); }

TEST(Decomposition, BlockFromScatteredOwners) {
  run(
      Domain{}, 600, [](int id) { return on_lattice(id, 12, 10); }, scattered);
}
TEST(Decomposition, PlaneFromScatteredOwners) {
  Domain domain;
  domain.dim = 2;
  run(
      domain, 400, [](int id) { return on_lattice(id, 25, 16); }, scattered);
}
TEST(Decomposition, OwnersByMajorityKeepEveryParticle) {
  run(
      Domain{}, 600, [](int id) { return on_lattice(id, 12, 10); }, scattered, false);
}
TEST(Decomposition, AllParticlesBeginOnTheLastRank) {
  run(
      Domain{}, 500, [](int id) { return on_lattice(id, 10, 10); }, [](int) { return Comm().size() - 1; });
}
TEST(Decomposition, AllParticlesInOneCell) {  // fewer cells than ranks: the others stay empty
  const ParticleSet p = run(
      Domain{}, 40, [](int id) { return on_lattice(id, 5, 4) * 0.1; }, scattered);
  EXPECT_EQ(Comm().sum(std::int64_t(p.owned() > 0)), 1);
}
TEST(Decomposition, AsManyCellsAsTwo) {
  run(
      Domain{}, 24, [](int id) { return on_lattice(id, 6, 2) * 0.7; }, scattered);
}
TEST(Decomposition, OneParticle) {
  run(
      Domain{}, 1,
      [](int) {
        return Vec3{3, -4, 5};
      },
      scattered);
}
TEST(Decomposition, NoParticles) {
  run(
      Domain{}, 0, [](int) { return Vec3{}; }, scattered);
}
TEST(Decomposition, TwoBodiesFarApart) {
  run(
      Domain{}, 300,
      [](int id) {
        return on_lattice(id % 150, 6, 5) + (id < 150 ? Vec3{-2000, 0, 0} : Vec3{3000, 500, -100});
      },
      scattered);
}
TEST(Decomposition, PeriodicBoxWrapsAndShifts) {
  Domain domain;
  domain.periodic = {true, true, true};
  domain.high = {8, 7, 9};
  // Positions several box lengths outside come back in.
  run(
      domain, 8 * 7 * 9,
      [](int id) {
        return on_lattice(id, 8, 7) + Vec3{8.0 * (id % 3 - 1), 14.0 * (id % 2), -9};
      },
      scattered);
}
TEST(Decomposition, PeriodicBoxOffTheOrigin) {
  Domain domain;
  domain.periodic = {false, true, false};
  domain.low = {0, -3.25, 0};
  domain.high = {0, 5.75, 0};
  run(
      domain, 6 * 9 * 5,
      [](int id) {
        return on_lattice(id, 6, 9) + Vec3{-3, -3.25, 2};
      },
      scattered);
}
TEST(Decomposition, OneLayerBetweenPeriodicFaces) {
  Domain domain;
  domain.periodic = {false, false, true};
  domain.high = {0, 0, 1};
  run(
      domain, 12 * 10, [](int id) { return on_lattice(id, 12, 10); }, scattered);
}
TEST(Decomposition, TwoLayersBetweenPeriodicFaces) {
  Domain domain;
  domain.periodic = {true, false, true};
  domain.high = {12, 0, 2};
  run(
      domain, 12 * 8 * 2,
      [](int id) {
        std::mt19937 noise(id);
        std::uniform_real_distribution<double> even(-0.3, 0.3);
        const double a = even(noise), b = even(noise), c = even(noise);
        return on_lattice(id, 12, 8) + Vec3{a, b, c};
      },
      scattered);
}
TEST(Decomposition, ThinInEveryDirection) {  // the whole box is smaller than the reach
  Domain domain;
  domain.periodic = {true, true, true};
  domain.high = {2, 1, 2};
  run(
      domain, 4, [](int id) { return on_lattice(id, 2, 1); }, scattered);
}

TEST(Decomposition, BalanceAfterRepartition) {
  const Comm comm;
  // A tube-like billet: a full disc under a thin wall.
  std::vector<Vec3> places;
  for (int k = 0; k < 24; ++k)
    for (int j = -16; j < 16; ++j)
      for (int i = -16; i < 16; ++i) {
        const double r = std::hypot(i + 0.5, j + 0.5);
        if (r < 16 && (k < 6 || r > 11)) places.push_back({i + 0.5, j + 0.5, k + 0.5});
      }
  const int n = static_cast<int>(places.size());
  ParticleSet p = make_particles(
      3, n, [&](int id) { return places[id]; }, [](int) { return 0; });
  const CellTable cells = Decomposition(comm).redistribute(p, Domain{}, reach, true, {});
  const double imbalance = comm.max(static_cast<double>(p.owned())) * comm.size() / n;
  const double fewest = comm.min(static_cast<double>(p.owned())) * comm.size() / n;
  if (comm.is_root())
    std::printf("%d particles on %d ranks: most loaded %.3f, least loaded %.3f of the mean\n", n, comm.size(),
                imbalance, fewest);
  // METIS aims at 1.03 (k-way) or 1.001 (bisection); a cell of 17 particles is 0.7 % of a quarter. Measured 1.01.
  EXPECT_LT(imbalance, 1.05);
  EXPECT_GT(fewest, 0.9);
  // Every cell has one owner, and the table knows it.
  for (std::size_t i = 0; i < p.owned(); ++i) {
    const auto ranks = cells.ranks_in(cells.key_of(p.vector_at(field::position, i)));
    ASSERT_EQ(ranks.size(), 1u);
    ASSERT_EQ(ranks[0].rank, comm.rank());
  }
}

TEST(Decomposition, WeightsShiftTheBalance) {
  const Comm comm;
  // Particles with x > 10 cost three times as much.
  ParticleSet p = make_particles(
      3, 20 * 10 * 10, [](int id) { return on_lattice(id, 20, 10) * 2.0; }, scattered);
  const auto cost = [&](std::size_t i) { return p.component(field::position, 0)[i] > 20 ? 3.0 : 1.0; };
  std::vector<double> weights(p.owned());
  for (std::size_t i = 0; i < weights.size(); ++i) weights[i] = cost(i);
  const double mean = comm.sum(std::accumulate(weights.begin(), weights.end(), 0.0)) / comm.size();
  // A rank without particles may hand in no weights; it must not hang the others.
  Decomposition(comm).redistribute(p, Domain{}, reach, true, weights);
  double own = 0;
  for (std::size_t i = 0; i < p.owned(); ++i) own += cost(i);
  const double imbalance = comm.max(own) / mean;
  if (comm.is_root()) std::printf("cost of the most loaded rank %.3f of the mean\n", imbalance);
  EXPECT_LT(imbalance, 1.08);
}

TEST(Decomposition, OwnershipFollowsTheMajority) {
  const Comm comm;
  ParticleSet p = make_particles(
      3, 600, [](int id) { return on_lattice(id, 12, 10); }, scattered);
  Decomposition decomposition(comm);
  decomposition.redistribute(p, Domain{}, reach, true, {});
  const std::size_t before = p.owned();
  const auto ids = [&] {
    const auto all = p[field::id].first(p.owned());
    std::vector<double> sorted(all.begin(), all.end());
    std::sort(sorted.begin(), sorted.end());
    return sorted;
  };
  const auto first = ids();
  decomposition.redistribute(p, Domain{}, reach, false, {});
  EXPECT_EQ(p.owned(), before);
  EXPECT_EQ(ids(), first) << "nothing moved, so nobody may change owner";
}

TEST(Decomposition, LostParticleStopsAllRanks) {
  for (double bad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(), 1e12}) {
    ParticleSet p = make_particles(
        3, 100, [](int id) { return on_lattice(id, 5, 5); }, scattered);
    // On one rank only: the one that has particle 17.
    for (std::size_t i = 0; i < p.owned(); ++i)
      if (p[field::id][i] == 17) p.component(field::position, 1)[i] = bad;
    try {
      Decomposition(Comm()).redistribute(p, Domain{}, reach, true, {});
      FAIL() << "no rank noticed";
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ExitCode::BlowUp);
      EXPECT_NE(std::string(error.what()).find("particle 17"), std::string::npos) << error.what();
    }
  }
}

}  // namespace
}  // namespace stirsph
