/// No pair may come within the kernel support unlisted while the neighbourhood says that the list holds, whatever the
/// particles do; and smooth motion must not use up the skin. On any number of ranks.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <random>
#include <set>
#include <vector>

#include "base/tensor.hpp"
#include "mechanics/neighbourhood.hpp"
#include "particles/field_names.hpp"

namespace stirsph {
namespace {

constexpr double support = 2.6, skin = 0.3;  // m; particles are about 1 m apart

struct Body {
  int dim = 3;
  std::array<int, 3> count{9, 8, 10};
  std::array<bool, 3> periodic{};
  std::function<bool(const Vec3&)> inside = [](const Vec3&) { return true; };
};

/// A moving crowd of particles: what Simulation does with the list, without mechanics.
class Crowd {
 public:
  Crowd(const Body& body, double noise)
      : particles(body.dim == 2 ? layout_of<PlaneStrain>() : layout_of<Cartesian3>()),
        domain_(domain_of(body)),
        neighbourhood(comm_, domain_, skin),
        noise_(noise) {
    Neighbourhood::add_fields(particles);
    particles.add(field::velocity);
    particles.add(field::acceleration);
    std::vector<std::pair<int, Vec3>> own;
    const int n = body.count[0] * body.count[1] * body.count[2];
    for (int id = 0; id < n; ++id) {
      const Vec3 x{0.5 + id % body.count[0], 0.5 + id / body.count[0] % body.count[1],
                   body.dim == 2 ? 0.0 : 0.5 + id / (body.count[0] * body.count[1])};
      if (body.inside(x) && id % comm_.size() == comm_.rank()) own.push_back({id, x});
    }
    particles.resize_owned(own.size());
    for (std::size_t i = 0; i < own.size(); ++i) {
      particles[field::id][i] = own[i].first;
      for (int d = 0; d < body.dim; ++d) particles.component(field::position, d)[i] = own[i].second[d];
    }
  }

  /// `flow(x, t)` is the velocity of the crowd; each particle wanders about it by itself.
  void set_velocities(const std::function<Vec3(const Vec3&, double)>& flow, double t) {
    for (std::size_t i = 0; i < particles.owned(); ++i) {
      std::mt19937_64 random(static_cast<std::uint64_t>(particles[field::id][i]) * 1000003 + step_);
      std::normal_distribution<double> normal(0, noise_);
      const Vec3 v = flow(particles.vector_at(field::position, i), t);
      for (int d = 0; d < domain_.dim; ++d) particles.component(field::velocity, d)[i] = v[d] + normal(random);
    }
  }

  /// Moves by dt as the step does: the next half kick is known when the list is judged. True when the list is new.
  bool step(const std::function<Vec3(const Vec3&, double)>& flow, double dt) {
    const auto agreed = [&] {
      ListMotion own = neighbourhood.motion(particles, Inertia{});
      for (double* value : {&own.deviation, &own.relative_speed, &own.displacement, &own.speed, &own.acceleration})
        *value = comm_.max(*value);
      return own;
    };
    if (step_ == 0) set_velocities(flow, time_);
    const bool renew = step_ == 0 || !neighbourhood.holds(agreed(), dt);
    for (int d = 0; d < domain_.dim; ++d)
      for (std::size_t i = 0; i < particles.owned(); ++i)
        particles.component(field::position, d)[i] += dt * particles.component(field::velocity, d)[i];
    neighbourhood.advance(dt);
    if (renew)
      neighbourhood.rebuild(particles, support, step_ == 0);
    else
      neighbourhood.halo().exchange(particles, Halo::Kinematic);
    step_ += 1;
    time_ += dt;
    set_velocities(flow, time_);
    return renew;
  }

  /// Pairs within the support that the list does not have, over all ranks.
  std::int64_t missing() const {
    std::array<std::vector<double>, 3> x;
    for (int d = 0; d < 3; ++d)
      x[d] = d < domain_.dim ? comm_.all_gather(std::vector<double>(
                                   particles.component(field::position, d).begin(),
                                   particles.component(field::position, d).begin() + particles.owned()))
                             : std::vector<double>(x[0].size());
    std::int64_t count = 0;
    const PairList& pairs = neighbourhood.pairs();
    for (std::size_t c = 0; c < pairs.clusters(); ++c)
      for (std::size_t i = c * cluster_size; i < std::min((c + 1) * cluster_size, particles.owned()); ++i) {
        const Vec3 here = particles.vector_at(field::position, i);
        for (const std::int32_t j : pairs.candidates(c))
          count -= norm(here - particles.vector_at(field::position, j)) < support;
        for (std::size_t j = 0; j < x[0].size(); ++j) {
          Vec3 d = here - Vec3{x[0][j], x[1][j], x[2][j]};
          // One direction is periodic at most, and thin layers have several images within the support.
          const int images = domain_.any_periodic() ? 4 : 0;
          for (int turns = -images; turns <= images; ++turns) {
            Vec3 image = d;
            for (int k = 0; k < domain_.dim; ++k)
              if (domain_.periodic[k]) image[k] += turns * domain_.length(k);
            count += norm(image) < support;
          }
        }
      }
    return comm_.sum(count);
  }

  ParticleSet particles;

 private:
  static Domain domain_of(const Body& body) {
    Domain domain{body.dim, body.periodic, {}, {}};
    for (int d = 0; d < body.dim; ++d) domain.high[d] = body.count[d];
    return domain;
  }
  Comm comm_;
  Domain domain_;

 public:
  Neighbourhood neighbourhood;

 private:
  double noise_;
  int step_ = 0;
  double time_ = 0;
};

using Flow = std::function<Vec3(const Vec3&, double)>;

/// Steps until `steps`; every step is compared with brute force. Returns the mean number of steps of a list.
double steps_per_list(const Body& body, const Flow& flow, double noise, double dt, int steps) {
  Crowd crowd(body, noise);
  int lists = 0;
  for (int k = 0; k < steps; ++k) {
    lists += crowd.step(flow, dt);
    const std::int64_t missing = crowd.missing();
    EXPECT_EQ(missing, 0) << "step " << k;
    if (missing != 0) break;
  }
  const double life = static_cast<double>(steps) / lists;
  if (Comm().is_root()) std::printf("%d steps, %d lists: %.1f steps a list\n", steps, lists, life);
  return life;
}

Vec3 about_z(const Vec3& x, const Vec3& centre, double rate) {
  return {-rate * (x.y - centre.y), rate * (x.x - centre.x), 0};
}

constexpr Vec3 centre{4.5, 4, 5};

TEST(ListLife, SurvivesTranslation) {
  // 0.1 m a step: absolute motion would use up the skin with the second step.
  EXPECT_GE(steps_per_list(
                {},
                [](const Vec3&, double) {
                  return Vec3{3, -2, 1};
                },
                0, 0.03, 8),
            8);
}

TEST(ListLife, SurvivesRotation) {
  // Corners 8 m away from the axis move 0.08 m a step.
  const Body body{3, {14, 10, 6}};
  EXPECT_GE(steps_per_list(
                body,
                [](const Vec3& x, double) {
                  return about_z(x, {7, 5, 3}, 1);
                },
                0, 0.01, 40),
            8);
}

TEST(ListLife, ShearCountsOnlyWithItsStretch) {
  // Half of the shear rate shortens: reach (1 - 0.5 gamma) = support after gamma = 0.21, plus curvature and walls.
  const double life = steps_per_list(
      {},
      [](const Vec3& x, double) {
        return Vec3{x.z, 0, 0};
      },
      0, 0.01, 60);
  EXPECT_GE(life, 12);
  EXPECT_LE(life, 25);  // a list that lived longer would miss pairs
}

TEST(ListLife, NeverMissesAPairInTurnShearAndNoise) {
  for (int seed = 0; seed < 6; ++seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> even(-1, 1);
    double g[3][3];
    for (auto& row : g)
      for (double& value : row) value = even(random);
    const double turn = 2 * even(random), wobble = even(random);
    const Flow flow = [=](const Vec3& x, double t) {
      const Vec3 d = x - centre;
      Vec3 v = about_z(x, centre, turn * (1 + wobble * std::sin(9 * t)));
      for (int a = 0; a < 3; ++a)
        for (int b = 0; b < 3; ++b) v[a] += 0.3 * g[a][b] * d[b] + 0.2 * std::sin(g[b][a] * d[b] + t);
      return v;
    };
    steps_per_list({}, flow, 0.2, 0.02, 40);
  }
}

TEST(ListLife, ForeseesTheNextStep) {
  // Random steps of a third of the skin each: a list that holds now may not hold a step later.
  for (int repeat = 0; repeat < 4; ++repeat)
    steps_per_list(
        {},
        [=](const Vec3&, double) {
          return Vec3{1.0 * repeat, 0, 0};
        },
        3, 0.02, 15);
}

TEST(ListLife, NeverMissesAPairInPlane) {
  const Flow flow = [](const Vec3& x, double t) {
    return about_z(x, {10, 7, 0}, 1 + std::sin(5 * t)) + Vec3{0.5 * std::sin(0.7 * x.y), 0.3 * x.x - 3, 0};
  };
  steps_per_list({2, {20, 15, 1}}, flow, 0.3, 0.01, 60);
}

TEST(ListLife, NeverMissesAPairBetweenPeriodicFaces) {
  for (int d = 0; d < 3; ++d) {
    Body body{3, {9, 8, 10}};
    body.periodic[d] = true;
    const Flow flow = [=](const Vec3& x, double t) {
      Vec3 v;
      v[d] = 4 + std::sin(x[(d + 1) % 3]);
      v[(d + 1) % 3] = 0.8 * std::sin(x[d] * 2 * 3.14159265358979 / body.count[d] + 3 * t);
      return v;
    };
    steps_per_list(body, flow, 0.1, 0.02, 40);
  }
  Body thin{3, {12, 12, 1}};
  thin.periodic[2] = true;
  steps_per_list(
      thin,
      [](const Vec3& x, double) {
        return about_z(x, {6, 6, 0}, 1) + Vec3{0, 0, x.x};
      },
      0.1, 0.01, 40);
}

/// Two blocks that fly at each other: pairs that were far apart when the list was made.
TEST(ListLife, NeverMissesBodiesThatMeet) {
  // The widest gap is more than what the smooth motion looks at: only the absolute displacement tells.
  for (const auto& [gap, dt] : {std::pair{1, 0.01}, {3, 0.01}, {5, 0.01}, {14, 0.05}}) {
    const Body body{3, {10 + gap, 5, 5}, {}, [edge = 5.0 + gap](const Vec3& x) { return x.x < 5 || x.x > edge; }};
    Crowd crowd(body, 0.05);
    for (int k = 0; k < 80; ++k) {
      crowd.step([](const Vec3&, double) { return Vec3{}; }, dt);
      // Each particle keeps the velocity of its block, also when it has passed the other one.
      for (std::size_t i = 0; i < crowd.particles.owned(); ++i)
        crowd.particles.component(field::velocity, 0)[i] +=
            static_cast<int>(crowd.particles[field::id][i]) % body.count[0] < 5 ? 5.0 : -5.0;
      ASSERT_EQ(crowd.missing(), 0) << "gap " << gap << ", step " << k;
    }
  }
}

}  // namespace
}  // namespace stirsph
