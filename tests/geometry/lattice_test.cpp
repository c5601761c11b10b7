/// The lattice that fills a shape with particles.
#include <gtest/gtest.h>

#include <string>

#include "base/error.hpp"
#include "geometry/combinations.hpp"
#include "geometry/lattice.hpp"
#include "geometry/primitives.hpp"

namespace stirsph {
namespace {

const Vec3 origin{0, 0, 0}, z_axis{0, 0, 1};

TEST(Lattice, BilletOfThePaper) {
  // R 12.5 mm, height 35 mm at 0.4 mm: 87 layers of 3,024 particles.
  const auto billet = make_cylinder(origin, z_axis, 0.0125, 0.035);
  const LatticeSlice all = fill_with_lattice(*billet, 0.0004);
  EXPECT_EQ(all.total, 263088);
  EXPECT_EQ(all.points.size(), 263088u);
  EXPECT_NEAR(all.points.front().z, 0.0002, 1e-15);
  EXPECT_EQ(all.points[3023].z, all.points[0].z);
  EXPECT_NEAR(all.points[3024].z, 0.0006, 1e-15);
  EXPECT_NEAR(all.points.back().z, 86.5 * 0.0004, 1e-15);
}

TEST(Lattice, PiecesDoNotDependOnTheNumberOfRanks) {
  const auto shape = make_annulus({0.1, 0.2, 0}, z_axis, 0.3, 1.0, 0.7);
  const LatticeSlice all = fill_with_lattice(*shape, 0.1);
  for (const int size : {2, 3, 7, 2000}) {
    std::vector<Vec3> gathered;
    for (int rank = 0; rank < size; ++rank) {
      const LatticeSlice piece = fill_with_lattice(*shape, 0.1, {}, rank, size);
      EXPECT_EQ(piece.total, all.total);
      EXPECT_EQ(piece.first, static_cast<std::int64_t>(gathered.size()));
      EXPECT_LE(piece.points.size(), static_cast<std::size_t>(all.total / size + 1));
      gathered.insert(gathered.end(), piece.points.begin(), piece.points.end());
    }
    EXPECT_EQ(gathered, all.points);
  }
}

TEST(Lattice, OriginAndMargin) {
  const Box box({0, 0, 0}, {1, 1, 1});
  EXPECT_EQ(fill_with_lattice(box, 0.1).total, 1000);
  // Particle surfaces end at the faces: the margin of a quarter takes 9.75 cells as 10 and 9.74 as 9.
  EXPECT_EQ(fill_with_lattice(Box({0, 0, 0}, {0.975, 1, 1}), 0.1).total, 1000);
  EXPECT_EQ(fill_with_lattice(Box({0, 0, 0}, {0.974, 1, 1}), 0.1).total, 900);
  EXPECT_EQ(fill_with_lattice(box, 0.1, {.origin = {0.05, 0, 0}}).total, 900);
  EXPECT_EQ(fill_with_lattice(box, 0.1, {.origin = {0.05, 0, 0}, .margin = 0.0}).total, 1100);
}

TEST(Lattice, TwoDimensions) {
  const auto disc = make_cylinder(origin, z_axis, 1, {});
  const LatticeSlice points = fill_with_lattice(*disc, 0.5, {.dimensions = 2});
  EXPECT_EQ(points.total, 12);
  for (const Vec3& p : points.points) EXPECT_EQ(p.z, 0);
  EXPECT_EQ(points.points[0].y, -0.75);
  EXPECT_EQ(points.points[0].x, -0.25);
}

TEST(Lattice, HalfPlane) {
  const auto rod = make_cylinder(origin, z_axis, 1, 2);
  for (const double y : {0.0, 0.25}) {  // the origin of a lattice in space may lie beside the half-plane
    const LatticeSlice points = fill_with_lattice(
        *rod, 0.5, {.dimensions = 2, .axes = {0, 2, 1}, .half_plane = true, .origin = {0, y, 0}, .margin = 0.25});
    EXPECT_EQ(points.total, 8);
    for (const Vec3& p : points.points) {
      EXPECT_EQ(p.y, 0);
      EXPECT_GT(p.x, 0);
    }
    EXPECT_EQ(points.points[7].x, 0.75);
    EXPECT_EQ(points.points[7].z, 1.75);
  }
}

TEST(Lattice, Errors) {
  const auto message = [](const ShapeFunction& shape, double spacing) {
    try {
      fill_with_lattice(shape, spacing);
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string("no error");
  };
  EXPECT_NE(message(*make_cylinder(origin, z_axis, 1, {}), 0.1).find("no end along z"), std::string::npos);
  EXPECT_NE(message(HalfSpace(origin, z_axis), 0.1).find("must be bounded"), std::string::npos);
  EXPECT_NE(message(Sphere(origin, 1), 5).find("no lattice point"), std::string::npos);
  EXPECT_NE(message(Sphere(origin, 1), 1e-9).find("Check the units"), std::string::npos);
  EXPECT_NE(message(Sphere(origin, 1), 0).find("must be > 0"), std::string::npos);
}

}  // namespace
}  // namespace stirsph
