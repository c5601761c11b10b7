/// Areas: of rigid surfaces shared out to the particles that touch them, and of free surfaces. Printed figures are the
/// table of src/thermal/README.md.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <functional>
#include <numbers>
#include <numeric>
#include <random>
#include <vector>

#include "support/lattice.hpp"
#include "thermal/conduction.hpp"
#include "thermal/contact_area.hpp"
#include "thermal/free_surface.hpp"
#include "thermal/heat_solver.hpp"

namespace stirsph {
namespace {

constexpr double pi = std::numbers::pi;
constexpr double dx = 0.4e-3;

using Inside = std::function<bool(double x, double y)>;  // in spacings

/// Moves each coordinate by up to +- jitter.
class Jitter {
 public:
  explicit Jitter(double jitter) : shift_(-jitter, jitter) {}
  Vec3 operator()(Vec3 point, int dim) {
    for (int d = 0; d < dim; ++d) point[d] += shift_(random_);
    return point;
  }

 private:
  std::mt19937_64 random_{1};
  std::uniform_real_distribution<double> shift_;
};

/// The feet shared out by this rank's part of them, the others within the neighbourhood as halo copies, in another
/// order than on one rank. Areas in the order of `feet`.
std::vector<double> areas_over_ranks(const std::vector<SurfaceFoot>& feet, int dim) {
  const Comm comm;
  std::vector<std::size_t> owned, halo;
  const std::size_t first = feet.size() * comm.rank() / comm.size();
  const std::size_t last = feet.size() * (comm.rank() + 1) / comm.size();
  for (std::size_t k = feet.size(); k-- > 0;) (k >= first && k < last ? owned : halo).push_back(k);
  std::erase_if(halo, [&](std::size_t k) {
    return std::none_of(owned.begin(), owned.end(), [&](std::size_t i) {
      return norm(feet[k].point - feet[i].point) < contact_neighbourhood * dx;
    });
  });
  std::vector<SurfaceFoot> mine;
  for (const std::size_t k : owned) mine.push_back(feet[k]);
  for (const std::size_t k : halo) mine.push_back(feet[k]);
  const auto areas =
      contact_areas(mine, owned.size(), dx, dim == 2 ? layout_of<PlaneStrain>() : layout_of<Cartesian3>());
  std::vector<double> result(feet.size(), 0.0);
  for (std::size_t k = 0; k < owned.size(); ++k) result[owned[k]] = areas[k];
  comm.sum_in_place(result);
  return result;
}

double sum(const std::vector<double>& values) { return std::accumulate(values.begin(), values.end(), 0.0); }

/// Feet on a plane of two layers of a lattice, turned about the plane's normal.
std::vector<SurfaceFoot> flat_feet(const Inside& inside, double angle = 0, double jitter = 0) {
  Jitter move(jitter);
  std::vector<SurfaceFoot> feet;
  for (int layer = 0; layer < 2; ++layer)
    for (int i = -20; i < 20; ++i)
      for (int j = -20; j < 20; ++j) {
        if (!inside(i + 0.5, j + 0.5)) continue;
        const Vec3 x = rotated(move({i + 0.5, j + 0.5, layer + 0.5}, 3), {0, 0, 1}, angle);
        feet.push_back({0, dx * Vec3{x.x, x.y, 0}, {0, 0, 1}, dx * x.z});
      }
  return feet;
}

struct Cylinder {
  double radius = 16, height = 10, margin = 0.25, jitter = 0, offset = 0, angle = 0;  // lengths in spacings
  bool free_ends = false;  // otherwise it goes on periodically
};

/// A lattice filled into a bore about z, turned about it. Feet of the height first, those of periodic copies behind.
std::vector<SurfaceFoot> bore_feet(const Cylinder& c, std::size_t& owned) {
  Jitter move(c.jitter);
  std::vector<SurfaceFoot> feet, copies;
  const int n = static_cast<int>(c.radius) + 2;
  for (int i = -n; i < n; ++i)
    for (int j = -n; j < n; ++j) {
      const double a = i + 0.5 + c.offset, b = j + 0.5 + 0.7 * c.offset;
      if (std::hypot(a, b) > c.radius - c.margin + 1e-9) continue;
      for (int k = 0; k < c.height; ++k) {
        const Vec3 x = rotated(move({a, b, k + 0.5}, 3), {0, 0, 1}, c.angle);
        const double r = std::hypot(x.x, x.y);
        if (r < c.radius - 2) continue;
        const Vec3 out{x.x / r, x.y / r, 0};
        SurfaceFoot foot{0, dx * (c.radius * out + Vec3{0, 0, x.z}), -out, dx * (c.radius - r)};
        feet.push_back(foot);
        if (c.free_ends || (k >= 4 && k < c.height - 4)) continue;
        foot.point.z += (k < 4 ? 1 : -1) * c.height * dx;
        copies.push_back(foot);
      }
    }
  owned = feet.size();
  feet.insert(feet.end(), copies.begin(), copies.end());
  return feet;
}

/// Relative error of the total.
double bore_error(const Cylinder& c) {
  std::size_t owned = 0;
  const auto feet = bore_feet(c, owned);
  return sum(contact_areas(feet, owned, dx, layout_of<Cartesian3>())) / (2 * pi * c.radius * c.height * dx * dx) - 1;
}

TEST(ContactArea, FlatLatticeIsExact) {
  // Rounding: some 100 terms per area.
  const auto feet = flat_feet([](double x, double y) { return std::abs(x) < 8 && std::abs(y) < 6; });
  const auto areas = areas_over_ranks(feet, 3);
  int interior = 0;
  for (std::size_t k = 0; k < feet.size(); ++k) {
    if (feet[k].distance > dx) {
      EXPECT_EQ(areas[k], 0) << "second layer";
    } else if (std::abs(feet[k].point.x) < 6 * dx && std::abs(feet[k].point.y) < 4 * dx) {
      EXPECT_NEAR(areas[k] / (dx * dx), 1, 1e-13);
      ++interior;
    }
  }
  EXPECT_EQ(interior, 12 * 8);
}

/// Turned against the axes the quadrature points of neighbours no longer coincide.
TEST(ContactArea, TurnedFlatLattice) {
  double worst = 0;
  for (const double angle : {0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, pi / 4}) {
    const auto feet = flat_feet([](double x, double y) { return std::abs(x) < 5 && std::abs(y) < 5; }, angle);
    const auto areas = contact_areas(feet, feet.size(), dx, layout_of<Cartesian3>());
    for (std::size_t k = 0; k < feet.size(); ++k)
      if (feet[k].distance < dx && norm(feet[k].point) < dx)
        worst = std::max(worst, std::abs(areas[k] / (dx * dx) - 1));
  }
  std::printf("turned lattice, area of one particle: %.2e\n", worst);
  EXPECT_LT(worst, 4e-3);  // quadrature error, measured
}

/// The edge is half a spacing outside the outermost centres. The loss that remains is at the corners, a twentieth of
/// dx^2 at each.
TEST(ContactArea, FlatPatches) {
  const Inside rectangle = [](double x, double y) { return std::abs(x) < 8 && std::abs(y) < 4; };
  for (const double angle : {0.0, 0.3, pi / 4})
    for (const double jitter : {0.0, 0.1, 0.2}) {
      const double error = sum(areas_over_ranks(flat_feet(rectangle, angle, jitter), 3)) / (128 * dx * dx) - 1;
      std::printf("rectangle 16 x 8, turned %.2f, jitter %.1f: %+.2f %%\n", angle, jitter, 100 * error);
      EXPECT_LT(std::abs(error), 0.01);  // measured: 0.8 %
    }
  for (const double radius : {8.0, 16.0})
    for (const double jitter : {0.0, 0.1}) {
      const auto feet = flat_feet([&](double x, double y) { return std::hypot(x, y) < radius; }, 0, jitter);
      const double total = sum(areas_over_ranks(feet, 3)) / (dx * dx);
      const double particles = static_cast<double>(feet.size()) / 2;
      std::printf("disc R %g, jitter %.1f: %+.2f %% of its particles' area, which is %+.2f %% off pi R^2\n", radius,
                  jitter, 100 * (total / particles - 1), 100 * (particles / (pi * radius * radius) - 1));
      EXPECT_LT(std::abs(total / particles - 1), 0.01);  // measured: 0.8 %
    }
}

/// Every place of the lattice in the bore, with and without ends: total 2 pi R H.
TEST(ContactArea, StaircaseInBore) {
  for (const double radius : {16.0, 31.0})
    for (const double jitter : {0.0, 0.1}) {
      double low = 1, high = -1;
      for (const bool free_ends : {false, true})
        for (const double offset : {0.0, 0.1, 0.25, 0.4, 0.5})
          for (const double angle : {0.0, 0.3}) {
            const double error = bore_error({radius, free_ends ? 20.0 : 10.0, 0.25, jitter, offset, angle, free_ends});
            low = std::min(low, error);
            high = std::max(high, error);
          }
      std::printf("bore R %g, jitter %.1f: %+.2f to %+.2f %%\n", radius, jitter, 100 * low, 100 * high);
      EXPECT_GT(low, -0.005);  // the requirement is 1 %, measured 0.3 %
      EXPECT_LT(high, 0.005);
    }
}

/// Against a fill with a margin of half a spacing the gap is up to 1.5 wide in places: not touched there.
TEST(ContactArea, WideGapsAreNotTouched) {
  const double near = bore_error({.radius = 16.1, .margin = 0.5}), wide = bore_error({.radius = 16.0, .margin = 0.5});
  std::printf("bore, fill margin 0.5: R 16.1 %+.1f %%, R 16.0 %+.1f %%\n", 100 * near, 100 * wide);
  EXPECT_GT(near, -0.15);
  EXPECT_LT(wide, -0.15);
}

/// At the limit and beyond it: nothing, and no 0/0.
TEST(ContactArea, EndsAtItsReach) {
  for (const double below : {1e-3, 1e-15, 0.0}) {
    const std::vector<SurfaceFoot> feet{{0, {}, {0, 0, 1}, contact_reach * (1 - below) * dx}};
    const double area = contact_areas(feet, 1, dx, layout_of<Cartesian3>())[0] / (dx * dx);
    // Alone a particle touches a disc of its own width; ten by ten quadrature points resolve it to some per cent.
    if (below > 1e-6)
      EXPECT_NEAR(area, pi / 4, 0.05);
    else
      EXPECT_EQ(area, 0);
  }
}

/// The same on any number of ranks and in any order, to rounding.
TEST(ContactArea, OrderAndRanksDoNotMatter) {
  std::size_t owned = 0;
  const auto feet = bore_feet({.radius = 8, .height = 12, .jitter = 0.1, .free_ends = true}, owned);
  const auto split = areas_over_ranks(feet, 3), whole = contact_areas(feet, feet.size(), dx, layout_of<Cartesian3>());
  for (std::size_t k = 0; k < feet.size(); ++k) EXPECT_NEAR(split[k], whole[k], 1e-13 * dx * dx);
}

TEST(ContactArea, SphereInSphericalShell) {
  for (const double radius : {8.0, 16.0}) {
    std::vector<SurfaceFoot> feet;
    const int n = static_cast<int>(radius) + 1;
    for (int i = -n; i < n; ++i)
      for (int j = -n; j < n; ++j)
        for (int k = -n; k < n; ++k) {
          const Vec3 x{i + 0.5, j + 0.5, k + 0.5};
          const double r = norm(x);
          if (r < radius - 0.25 && r > radius - 2) feet.push_back({0, dx * radius / r * x, -x / r, dx * (radius - r)});
        }
    const double error = sum(areas_over_ranks(feet, 3)) / (4 * pi * radius * radius * dx * dx) - 1;
    std::printf("sphere in a shell R %g: %+.2f %%\n", radius, 100 * error);
    EXPECT_LT(std::abs(error), 0.005);  // measured 0.2 %; 0.9 % if the surface were not unrolled
  }
}

/// Material all around an edge of the rigid body: the two faces and the particle between them share what there is.
TEST(ContactArea, EdgeOfTheRigidBody) {
  std::vector<SurfaceFoot> feet;  // the rigid body is x < 0, y < 0; 8 spacings of each face are covered
  for (int k = -10; k < 10; ++k) {
    for (int i = 0; i < 8; ++i) {
      feet.push_back({0, dx * Vec3{0, -i - 0.5, k + 0.5}, {1, 0, 0}, 0.5 * dx});
      feet.push_back({0, dx * Vec3{-i - 0.5, 0, k + 0.5}, {0, 1, 0}, 0.5 * dx});
    }
    feet.push_back({0, dx * Vec3{0, 0, k + 0.5}, normalised(Vec3{1, 1, 0}), std::sqrt(0.5) * dx});
  }
  const double excess = (sum(areas_over_ranks(feet, 3)) / (dx * dx) - 2 * 8 * 20) / 20;
  std::printf("edge of the rigid body: %+.3f dx of width too much\n", excess);
  EXPECT_LT(std::abs(excess), 0.2);
}

/// Two sides of a sheet thinner than the neighbourhood do not take from each other.
TEST(ContactArea, TwoSidesOfASheet) {
  auto feet = flat_feet([](double x, double y) { return std::abs(x) < 6 && std::abs(y) < 6; });
  const double one_side = sum(contact_areas(feet, feet.size(), dx, layout_of<Cartesian3>()));
  const std::size_t n = feet.size();
  for (std::size_t k = 0; k < n; ++k) {
    SurfaceFoot below = feet[k];
    below.point.z -= 0.5 * dx;
    below.normal = -below.normal;
    feet.push_back(below);
  }
  EXPECT_NEAR(sum(contact_areas(feet, feet.size(), dx, layout_of<Cartesian3>())) / one_side, 2, 1e-12);
}

TEST(ContactArea, LinesInThePlane) {
  std::vector<SurfaceFoot> feet;
  for (int layer = 0; layer < 2; ++layer)
    for (int i = 0; i < 12; ++i) feet.push_back({0, {(i + 0.5) * dx, 0, 0}, {0, 1, 0}, (layer + 0.5) * dx});
  const auto areas = areas_over_ranks(feet, 2);
  EXPECT_NEAR(areas[5] / dx, 1, 1e-13);
  EXPECT_NEAR(sum(areas) / dx, 12, 1e-12);

  for (const double radius : {16.0, 31.0})
    for (const double offset : {0.0, 0.1, 0.25, 0.4}) {
      feet.clear();
      const int n = static_cast<int>(radius) + 2;
      for (int i = -n; i < n; ++i)
        for (int j = -n; j < n; ++j) {
          const Vec3 x{i + 0.5 + offset, j + 0.5 + 0.7 * offset, 0};
          const double r = norm(x);
          if (r < radius - 0.25 && r > radius - 2) feet.push_back({0, dx * radius / r * x, -x / r, dx * (radius - r)});
        }
      const double error = sum(areas_over_ranks(feet, 2)) / (2 * pi * radius * dx) - 1;
      std::printf("circle R %g, offset %.2f: %+.2f %%\n", radius, offset, 100 * error);
      EXPECT_LT(std::abs(error), 0.01);
    }
}

// ---- free surfaces -------------------------------------------------------------------------------------------------

using testing::Lattice;
using testing::LatticeBody;

/// Rigid surfaces a particle may be near: appends its feet (in metres).
using Walls = std::function<void(std::int32_t particle, const Vec3& x, std::vector<SurfaceFoot>& feet)>;

/// Total free area over dx^(dim - 1); `of` receives position (in spacings) and area of every particle of this rank.
double free_total(const Lattice& lattice, const Walls& walls = {},
                  const std::function<void(const Vec3&, double)>& of = {}) {
  LatticeBody body(Comm(), lattice, HeatSolver::add_fields);
  const ConductionOperator op{CubicSpline{}, 1, lattice_kernel_sum(CubicSpline{}, lattice.dim, lattice.h_over_dx)};
  HeatGraph().build(body.particles, body.pairs, op);
  std::vector<SurfaceFoot> feet;
  for (std::size_t i = 0; walls && i < body.particles.owned(); ++i)
    walls(static_cast<std::int32_t>(i), body.particles.vector_at(field::position, i), feet);
  const auto areas = free_surface_areas(body.particles, body.pairs, feet);
  const double unit = std::pow(lattice.spacing, lattice.dim - 1);
  for (std::size_t i = 0; of && i < areas.size(); ++i)
    of(body.particles.vector_at(field::position, i) / lattice.spacing, areas[i] / unit);
  return Comm().sum(sum(areas)) / unit;
}

Lattice box(int nx, int ny, int nz, double jitter = 0) {
  Lattice lattice;
  lattice.count = {nx, ny, nz};
  lattice.spacing = dx;
  lattice.jitter = jitter;
  return lattice;
}

TEST(FreeSurface, FlatFacesAreExact) {
  // Rounding of some 400 terms.
  Lattice slab = box(10, 8, 8);
  slab.periodic = {false, true, true};
  free_total(slab, {},
             [](const Vec3& x, double area) { EXPECT_NEAR(area, x.x < 1 || x.x > 9 ? 1.0 : 0.0, 1e-12) << x.x; });
  slab = box(8, 10, 1);
  slab.dim = 2;
  slab.periodic = {true, false, false};
  free_total(slab, {},
             [](const Vec3& x, double area) { EXPECT_NEAR(area, x.y < 1 || x.y > 9 ? 1.0 : 0.0, 1e-12) << x.y; });
}

TEST(FreeSurface, Disorder) {
  for (const double jitter : {0.1, 0.2}) {
    Lattice slab = box(16, 16, 16, jitter);
    slab.periodic = {false, true, true};
    double inside = 0;
    const double total = free_total(slab, {}, [&](const Vec3& x, double area) {
      if (x.x > 1.5 && x.x < 14.5) inside += area;
    });
    inside = Comm().sum(inside);
    std::printf("slab 16 thick, jitter %.1f: faces %+.2f %%, inside %.3f %% of the faces\n", jitter,
                100 * (total / 512 - 1), 100 * inside / 512);
    EXPECT_NEAR(total / 512, 1, 0.02);
    EXPECT_LT(inside / 512, 0.01);  // the requirement; measured: 0.003 and 0.5 %
  }
}

TEST(FreeSurface, Cube) {
  // Of a particle at an edge the sphere shows 1.74 faces, not 2 (its own geometry).
  for (const int n : {10, 20})
    for (const double jitter : {0.0, 0.1}) {
      const double total = free_total(box(n, n, n, jitter));
      std::printf("cube %d, jitter %.1f: %+.2f %%, per edge %+.2f dx\n", n, jitter, 100 * (total / (6 * n * n) - 1),
                  (total - 6 * n * n) / (12 * n));
      EXPECT_LT(std::abs(total - 6 * n * n) / (12 * n), 0.3);
    }
}

/// Curved outwards, the sphere looks out farther than the surface, by half a spacing in R; walls of a tube balance.
TEST(FreeSurface, RoundBodies) {
  for (const double radius : {8.0, 16.0}) {
    const int n = static_cast<int>(2 * radius);
    Lattice ball = box(n, n, n);
    ball.inside = [&](const Vec3& x) { return norm(x - radius * dx * Vec3{1, 1, 1}) < radius * dx; };
    const double error = free_total(ball) / (4 * pi * radius * radius) - 1;
    std::printf("sphere R %g: %+.2f %%\n", radius, 100 * error);
    EXPECT_LT(std::abs(error), 1 / radius);  // ((R + 0.45) / R)^2 - 1
  }
  for (const double radius : {8.0, 16.0}) {
    Lattice cylinder = box(static_cast<int>(2 * radius), static_cast<int>(2 * radius), 8);
    cylinder.periodic[2] = true;
    cylinder.inside = [&](const Vec3& x) { return std::hypot(x.x - radius * dx, x.y - radius * dx) < radius * dx; };
    const double error = free_total(cylinder) / (2 * pi * radius * 8) - 1;
    std::printf("endless cylinder R %g: %+.2f %%\n", radius, 100 * error);
    EXPECT_LT(std::abs(error), 0.6 / radius);
  }
  for (const double wall : {2.0, 3.0, 4.0}) {
    Lattice tube = box(24, 24, 8);
    tube.periodic[2] = true;
    tube.inside = [&](const Vec3& x) {
      const double r = std::hypot(x.x / dx - 12, x.y / dx - 12);
      return r < 12 && r > 12 - wall;
    };
    const double error = free_total(tube) / (2 * pi * (24 - wall) * 8) - 1;
    std::printf("tube R 12, wall %g: %+.2f %%\n", wall, 100 * error);
    EXPECT_LT(std::abs(error), 0.03);
  }
}

/// A billet in a bore on a plate: only its top is free, however long it is.
TEST(FreeSurface, BilletInBoreOnPlate) {
  for (const double radius : {8.0, 16.0})
    for (const double jitter : {0.0, 0.1})
      for (const int height : {10, 20}) {
        Lattice billet = box(static_cast<int>(2 * radius), static_cast<int>(2 * radius), height, jitter);
        const Vec3 axis{radius * dx, radius * dx, 0};
        const double fill = (radius - 0.25) * dx;
        billet.inside = [&](const Vec3& x) { return std::hypot(x.x - axis.x, x.y - axis.y) < fill; };
        std::vector<double> particles(1, 0.0);
        const double total = free_total(billet, [&](std::int32_t i, const Vec3& x, std::vector<SurfaceFoot>& feet) {
          const Vec3 out = normalised(Vec3{x.x - axis.x, x.y - axis.y, 0});
          const Vec3 foot = axis + radius * dx * out + Vec3{0, 0, x.z};
          feet.push_back({i, foot, -out, norm(foot - x)});
          feet.push_back({i, {x.x, x.y, 0}, {0, 0, 1}, x.z});
          particles[0] += 1;
        });
        Comm().sum_in_place(particles);
        const double top = particles[0] / height;
        std::printf(
            "billet R %g, height %d, jitter %.1f: %+.2f %% of its particles' top, which is %+.2f %% off pi R^2\n",
            radius, height, jitter, 100 * (total / top - 1), 100 * (top / (pi * radius * radius) - 1));
        EXPECT_NEAR(total / top, 1, 0.03);
      }
}

/// Areas by particle id.
std::vector<double> free_areas_by_id(const Comm& comm, const Lattice& lattice) {
  LatticeBody body(comm, lattice, HeatSolver::add_fields);
  HeatGraph().build(body.particles, body.pairs, {CubicSpline{}, 1, lattice_kernel_sum(CubicSpline{}, 3, 1.3)});
  const auto areas = free_surface_areas(body.particles, body.pairs, {});
  std::vector<double> result(lattice.count[0] * lattice.count[1] * lattice.count[2], 0.0);
  for (std::size_t i = 0; i < areas.size(); ++i)
    result[static_cast<std::size_t>(body.particles[field::id][i])] = areas[i];
  comm.sum_in_place(result);
  return result;
}

TEST(FreeSurface, RanksDoNotMatter) {
  Lattice ball = box(12, 12, 12, 0.1);
  ball.inside = [&](const Vec3& x) { return norm(x - 6 * dx * Vec3{1, 1, 1}) < 6 * dx; };
  const auto split = free_areas_by_id(Comm(), ball), whole = free_areas_by_id(Comm(MPI_COMM_SELF), ball);
  EXPECT_GT(sum(whole), 0);
  for (std::size_t k = 0; k < whole.size(); ++k) EXPECT_NEAR(split[k], whole[k], 1e-13 * dx * dx);
}

}  // namespace
}  // namespace stirsph
