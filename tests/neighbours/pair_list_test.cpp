/// Pair lists and storage order against brute force, with halo copies and periodic images, on any number of ranks.
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <random>
#include <set>
#include <vector>

#include "support/lattice.hpp"

namespace stirsph {
namespace {

using testing::Lattice;
using testing::LatticeBody;

/// Positions of all particles of all ranks, by id.
struct Everything {
  std::vector<double> id;
  std::array<std::vector<double>, 3> x;
};
Everything gather(const ParticleSet& particles) {
  const Comm comm;
  const auto owned = [&](std::span<const double> values) {
    return comm.all_gather(std::vector<double>(values.begin(), values.begin() + particles.owned()));
  };
  Everything all;
  all.id = owned(particles[field::id]);
  for (int d = 0; d < particles.layout().dim; ++d) all.x[d] = owned(particles.component(field::position, d));
  for (int d = particles.layout().dim; d < 3; ++d) all.x[d].assign(all.id.size(), 0.0);
  return all;
}

/// Every pair of an owned particle i and a particle or image j within reach must stand in the list of i's cluster
/// exactly once, and the list holds nothing that is out of reach of its whole cluster.
void compare_with_brute_force(const ParticleSet& particles, const PairList& pairs, const Domain& domain, double reach) {
  const Everything all = gather(particles);
  std::array<int, 3> images{};
  for (int d = 0; d < domain.dim; ++d)
    if (domain.periodic[d]) images[d] = static_cast<int>(std::ceil(reach / domain.length(d))) + 1;
  ASSERT_EQ(pairs.clusters(), particles.clusters());
  const auto id = particles[field::id];
  long expected = 0, missing = 0, doubled = 0, useless = 0, selfless = 0, candidates = 0;
  for (std::size_t c = 0; c < pairs.clusters(); ++c) {
    const auto list = pairs.candidates(c);
    candidates += static_cast<long>(list.size());
    const std::size_t first = c * cluster_size, last = std::min(first + cluster_size, particles.owned());
    std::set<std::int32_t> distinct(list.begin(), list.end());
    if (distinct.size() != list.size()) doubled += 1;
    std::vector<bool> used(list.size(), false);
    for (std::size_t i = first; i < last; ++i) {
      if (!distinct.count(static_cast<std::int32_t>(i))) selfless += 1;
      const Vec3 xi = particles.vector_at(field::position, i);
      // What the list says ...
      std::multiset<std::pair<long, std::array<long, 3>>> listed;  // id and position in units of reach/1e6
      const auto mark = [&](double number, const Vec3& x) {
        return std::pair<long, std::array<long, 3>>{
            static_cast<long>(number),
            {std::lround(x.x / reach * 1e6), std::lround(x.y / reach * 1e6), std::lround(x.z / reach * 1e6)}};
      };
      const double inside = reach * (1 - 1e-9);
      for (std::size_t k = 0; k < list.size(); ++k) {
        ASSERT_GE(list[k], 0);
        ASSERT_LT(static_cast<std::size_t>(list[k]), particles.total());
        const Vec3 d = xi - particles.vector_at(field::position, list[k]);
        if (norm(d) <= reach * (1 + 1e-9)) used[k] = true;
        if (norm(d) <= inside) listed.insert(mark(id[list[k]], d));
      }
      // ... and what is true.
      std::multiset<std::pair<long, std::array<long, 3>>> truth;
      for (std::size_t j = 0; j < all.id.size(); ++j) {
        const Vec3 base{all.x[0][j], all.x[1][j], all.x[2][j]};
        for (int a = -images[0]; a <= images[0]; ++a)
          for (int b = -images[1]; b <= images[1]; ++b)
            for (int e = -images[2]; e <= images[2]; ++e) {
              Vec3 shift;
              for (int d = 0; d < domain.dim; ++d)
                if (domain.periodic[d]) shift[d] = (d == 0 ? a : d == 1 ? b : e) * domain.length(d);
              const Vec3 d = xi - (base + shift);
              if (norm(d) <= inside) truth.insert(mark(all.id[j], d));
            }
      }
      expected += static_cast<long>(truth.size());
      // Rounding of the marks may differ by one unit between the two, so compare sizes and ids.
      std::vector<long> a, b;
      for (const auto& [number, x] : listed) a.push_back(number);
      for (const auto& [number, x] : truth) b.push_back(number);
      if (a != b) missing += 1;
    }
    useless += std::count(used.begin(), used.end(), false);
  }
  EXPECT_EQ(missing, 0) << "particles whose list is not the brute-force one";
  EXPECT_EQ(doubled, 0);
  EXPECT_EQ(selfless, 0);
  EXPECT_EQ(useless, 0);
  const Comm comm;
  const auto pairs_in_reach = comm.sum(std::int64_t(expected)), listed = comm.sum(std::int64_t(candidates * 8));
  if (comm.is_root())
    std::printf("%lld pairs within reach, %lld lane pairs in the list\n", static_cast<long long>(pairs_in_reach),
                static_cast<long long>(listed));
}

void check_lattice(const Lattice& lattice) {
  LatticeBody body(Comm(), lattice, [](ParticleSet&) {});
  const double reach = lattice.support * lattice.h_over_dx * lattice.spacing * (1 + 1e-9);
  compare_with_brute_force(body.particles, body.pairs, body.domain, reach);
}

TEST(PairList, LatticeInSpace) { check_lattice({.count = {9, 7, 6}}); }
TEST(PairList, LatticeInPlane) { check_lattice({.count = {23, 19, 1}, .dim = 2}); }
TEST(PairList, JitteredPeriodicInSpace) {
  check_lattice({.count = {8, 7, 9}, .periodic = {true, false, true}, .jitter = 0.3});
}
TEST(PairList, JitteredPeriodicInPlane) {
  check_lattice({.count = {17, 12, 1}, .periodic = {true, true, false}, .jitter = 0.3, .dim = 2});
}
TEST(PairList, OneLayerBetweenPeriodicFaces) {  // five images of every particle within reach
  check_lattice({.count = {8, 8, 1}, .periodic = {false, false, true}});
}
TEST(PairList, TwoLayersBetweenPeriodicFacesInPlane) {
  check_lattice({.count = {19, 2, 1}, .periodic = {false, true, false}, .jitter = 0.1, .dim = 2});
}
TEST(PairList, QuinticReach) { check_lattice({.count = {8, 8, 8}, .h_over_dx = 1.0, .support = 3, .jitter = 0.2}); }

/// Particles thrown at random, dense in one place and thin in another; nothing like a lattice.
ParticleSet random_particles(const Comm& comm, int dim, int n) {
  ParticleSet particles(dim == 2 ? layout_of<PlaneStrain>() : layout_of<Cartesian3>());
  for (const FieldInfo* info :
       {&field::id, &field::material, &field::mass, &field::position, &field::volume, &field::smoothing_length})
    particles.add(*info);
  const int first = n * comm.rank() / comm.size(), last = n * (comm.rank() + 1) / comm.size();
  particles.resize_owned(last - first);
  for (int id = first; id < last; ++id) {
    std::mt19937_64 random(id + 12345);
    std::uniform_real_distribution<double> even(0, 1);
    particles[field::id][id - first] = id;
    for (int d = 0; d < dim; ++d) {
      const double u = even(random);
      particles.component(field::position, d)[id - first] = 6 * u * u - 2;
    }
  }
  return particles;
}

void check_random(int dim, std::array<bool, 3> periodic) {
  const Comm comm;
  ParticleSet particles = random_particles(comm, dim, 500);
  Domain domain;
  domain.dim = dim;
  domain.periodic = periodic;
  domain.low = {-2, -2, -2};
  domain.high = {4, 4, 4};
  const double reach = 0.9;
  const CellTable cells = Decomposition(comm).redistribute(particles, domain, reach, true, {});
  particles.reorder(cluster_order(particles));
  HaloExchange halo(comm);
  halo.build(particles, cells, reach);
  PairList pairs;
  pairs.build(particles, reach);
  compare_with_brute_force(particles, pairs, domain, reach);
}

TEST(PairList, RandomInSpace) { check_random(3, {}); }
TEST(PairList, RandomInPlane) { check_random(2, {}); }
TEST(PairList, RandomPeriodicInSpace) { check_random(3, {true, true, true}); }
TEST(PairList, RandomPeriodicInPlane) { check_random(2, {false, true, false}); }

TEST(PairList, EmptyAndLone) {
  ParticleSet particles(layout_of<Cartesian3>());
  for (const FieldInfo* info : {&field::id, &field::position}) particles.add(*info);
  PairList pairs;
  pairs.build(particles, 1.0);
  EXPECT_EQ(pairs.clusters(), 0u);
  particles.resize_owned(1);
  pairs.build(particles, 1.0);
  ASSERT_EQ(pairs.clusters(), 1u);
  ASSERT_EQ(pairs.candidates(0).size(), 1u);
  EXPECT_EQ(pairs.candidates(0)[0], 0);
}

TEST(PairList, StrayParticleDoesNotExplodeMemory) {
  // A particle a thousand million spacings away would ask for 1e27 cells on a plain grid.
  const auto build = [](double stray) {
    ParticleSet particles(layout_of<Cartesian3>());
    for (const FieldInfo* info : {&field::id, &field::position}) particles.add(*info);
    constexpr int n = 12;
    particles.resize_owned(n * n * n);
    for (int i = 0; i < n * n * n; ++i) {
      particles[field::id][i] = i;
      particles.component(field::position, 0)[i] = i % n;
      particles.component(field::position, 1)[i] = i / n % n;
      particles.component(field::position, 2)[i] = i / (n * n);
    }
    for (int d = 0; d < 3; ++d) particles.component(field::position, d)[17] += stray;
    particles.reorder(cluster_order(particles));
    PairList pairs;
    pairs.build(particles, 2.6);
    compare_with_brute_force(particles, pairs, Domain{}, 2.6);
    return pairs.bytes();
  };
  if (Comm().size() > 1) GTEST_SKIP() << "the same on every rank";
  const std::size_t usual = build(0);
  rusage before{}, after{};
  getrusage(RUSAGE_SELF, &before);
  const std::size_t strayed = build(1e9);
  getrusage(RUSAGE_SELF, &after);
  const double grown = static_cast<double>(after.ru_maxrss - before.ru_maxrss) / 1024;
  std::printf("pair list %zu bytes, with a stray particle %zu bytes, memory grown by %.1f MiB\n", usual, strayed,
              grown);
  EXPECT_LT(strayed, 3 * usual);
#ifndef __SANITIZE_ADDRESS__  // it keeps what was freed, to notice its use
  EXPECT_LT(grown, 16);       // the grid may hold 8 cells a particle: 0.1 MiB here; measured below 1 MiB
#endif
}

TEST(ClusterOrder, IsAPermutationAndForgetsTheOldOrder) {
  for (int dim : {2, 3}) {
    const int n = dim == 2 ? 400 : 1000 + 3;  // with a cluster that is not full
    ParticleSet particles(dim == 2 ? layout_of<PlaneStrain>() : layout_of<Cartesian3>());
    for (const FieldInfo* info : {&field::id, &field::position}) particles.add(*info);
    particles.resize_owned(n);
    for (int i = 0; i < n; ++i) {
      particles[field::id][i] = i;
      // A lattice: many equal coordinates, the hard case for a stable choice.
      particles.component(field::position, 0)[i] = i % 10;
      particles.component(field::position, 1)[i] = i / 10 % 10;
      if (dim == 3) particles.component(field::position, 2)[i] = i / 100;
    }
    std::vector<double> reference;
    std::mt19937 random(7);
    for (int attempt = 0; attempt < 5; ++attempt) {
      const auto order = cluster_order(particles);
      std::vector<std::int32_t> sorted = order;
      std::sort(sorted.begin(), sorted.end());
      ASSERT_EQ(sorted.size(), static_cast<std::size_t>(n));
      for (int i = 0; i < n; ++i) ASSERT_EQ(sorted[i], i);
      particles.reorder(order);
      const auto ids = particles[field::id];
      std::vector<double> now(ids.begin(), ids.begin() + n);
      if (attempt == 0) reference = now;
      EXPECT_EQ(now, reference) << "the order depends on the incoming one";
      std::vector<std::int32_t> mixed = sorted;
      std::shuffle(mixed.begin(), mixed.end(), random);
      particles.reorder(mixed);
    }
  }
}

TEST(ClusterOrder, ClustersOfALatticeAreCompact) {
  constexpr int n = 16;
  ParticleSet particles(layout_of<Cartesian3>());
  for (const FieldInfo* info : {&field::id, &field::position}) particles.add(*info);
  particles.resize_owned(n * n * n);
  for (int i = 0; i < n * n * n; ++i) {
    particles[field::id][i] = i;
    particles.component(field::position, 0)[i] = i % n;
    particles.component(field::position, 1)[i] = i / n % n;
    particles.component(field::position, 2)[i] = i / (n * n);
  }
  particles.reorder(cluster_order(particles));
  for (std::size_t c = 0; c < particles.clusters(); ++c)
    for (int d = 0; d < 3; ++d) {
      const auto x = particles.component(field::position, d).subspan(c * cluster_size, cluster_size);
      EXPECT_LE(*std::max_element(x.begin(), x.end()) - *std::min_element(x.begin(), x.end()), 1.0);
    }
}

}  // namespace
}  // namespace stirsph
