/// Shapes: distances against closed forms and against sampled surfaces, normals against differences, bounds, input.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <fstream>
#include <random>

#include "base/error.hpp"
#include "geometry/combinations.hpp"
#include "geometry/primitives.hpp"
#include "geometry/shape_input.hpp"
#include "geometry/tabulated_curve.hpp"
#include "support/distance_gradient.hpp"

namespace stirsph {
namespace {

const Vec3 origin{0, 0, 0}, z_axis{0, 0, 1}, slanted{1, 2, 2};

std::vector<ShapePointer> primitives() {
  return {std::make_shared<HalfSpace>(Vec3{0.1, 0.2, 0.3}, slanted),
          std::make_shared<Box>(Vec3{-0.5, -0.3, -0.2}, Vec3{0.4, 0.6, 0.1}),
          std::make_shared<Sphere>(Vec3{0.1, -0.1, 0.2}, 0.7),
          std::make_shared<Torus>(Vec3{0.1, 0, 0.1}, slanted, 0.6, 0.2),
          make_cylinder({0.1, 0, -0.4}, slanted, 0.4, 0.8),
          make_cylinder({0.1, 0, -0.4}, slanted, 0.4, {}),
          make_annulus({0.1, 0, -0.4}, slanted, 0.3, 0.6, 0.8),
          make_annulus({0.1, 0, -0.4}, slanted, 0.3, 0.6, {}),
          make_frustum({0, 0.1, -0.4}, slanted, 0.6, 0.2, 0.9),
          make_frustum({0, 0.1, -0.4}, slanted, 0.0, 0.5, 0.9)};
}

std::vector<ShapePointer> all_shapes() {
  auto shapes = primitives();
  const auto block = std::make_shared<Box>(Vec3{-0.6, -0.6, -0.6}, Vec3{0.6, 0.6, 0.2});
  shapes.push_back(std::make_shared<Difference>(block, std::vector{make_cylinder(origin, z_axis, 0.3, {})}));
  shapes.push_back(std::make_shared<Union>(std::vector<ShapePointer>{block, make_cylinder(origin, z_axis, 0.3, 0.8)}));
  return shapes;
}

/// A cylinder cut along its axis: beyond its straight edges the distance is right to first order only.
ShapePointer half_cylinder() {
  return std::make_shared<Intersection>(std::vector<ShapePointer>{make_cylinder({0, 0, -0.5}, z_axis, 0.5, 1.0),
                                                                  std::make_shared<HalfSpace>(origin, Vec3{1, 0, 0})});
}

std::vector<Vec3> random_points(int count) { return testing::random_points(count, 1.3, 7); }

TEST(Shapes, NormalIsTheGradientOfTheDistance) {
  for (const auto& shape : all_shapes()) {
    int smooth = 0;
    for (const Vec3& p : random_points(3000)) {
      const SurfacePoint at = shape->nearest(p);
      EXPECT_NEAR(norm(at.normal), 1, 1e-12) << shape->describe();
      const auto gradient = testing::distance_gradient(*shape, p);
      if (!gradient) continue;
      ++smooth;
      EXPECT_LT(norm(*gradient - at.normal), 2e-3) << shape->describe() << " at " << p.x << " " << p.y << " " << p.z;
    }
    EXPECT_GT(smooth, 2800) << shape->describe();
  }
}

TEST(Shapes, FootOfThePerpendicularLiesOnTheSurface) {
  for (const auto& shape : primitives())
    for (const Vec3& p : random_points(2000)) {
      const SurfacePoint at = shape->nearest(p);
      EXPECT_NEAR(shape->distance(p - at.distance * at.normal), 0, 1e-12) << shape->describe();
      // No surface point is closer: the ball of radius |distance| holds none.
      for (const Vec3& q : {Vec3{1, 0, 0}, Vec3{0, 0, -1}, normalised(Vec3{1, -1, 1})}) {
        const Vec3 on_ball = p + 0.999 * std::abs(at.distance) * q;
        EXPECT_EQ(std::signbit(shape->distance(on_ball)), std::signbit(at.distance)) << shape->describe();
      }
    }
}

TEST(Shapes, KnownDistances) {
  const auto cylinder = make_cylinder(origin, z_axis, 2, 3.0);
  EXPECT_DOUBLE_EQ(cylinder->distance({5, 0, 1}), 3);
  EXPECT_DOUBLE_EQ(cylinder->distance({0, 0, 1}), -1);
  EXPECT_DOUBLE_EQ(cylinder->distance({0, 1.5, 1}), -0.5);
  EXPECT_DOUBLE_EQ(cylinder->distance({5, 0, 7}), 5);  // to the rim: 3-4-5
  EXPECT_DOUBLE_EQ(cylinder->distance({0, 0, -2}), 2);
  EXPECT_EQ(cylinder->nearest({2, 0, 1}).normal, (Vec3{1, 0, 0}));
  EXPECT_EQ(cylinder->nearest({0, 0, 3}).normal, z_axis);
  const auto annulus = make_annulus(origin, z_axis, 1, 2, 3.0);
  EXPECT_DOUBLE_EQ(annulus->distance({0, 0, 1}), 1);
  EXPECT_DOUBLE_EQ(annulus->distance({1.25, 0, 1}), -0.25);
  EXPECT_EQ(annulus->nearest({1.25, 0, 1}).normal, (Vec3{-1, 0, 0}));
  EXPECT_DOUBLE_EQ(annulus->distance({0.7, 0, 3.4}), 0.5);  // to the inner rim
  const Box box({0, 0, 0}, {1, 1, 1});
  EXPECT_DOUBLE_EQ(box.distance({4, 5, 0.5}), 5);
  EXPECT_DOUBLE_EQ(box.distance({0.9, 0.5, 0.5}), -0.1);
  const auto cone = make_frustum(origin, z_axis, 1, 0, 1);
  EXPECT_NEAR(cone->distance({1, 0, 1}), std::sqrt(0.5), 1e-15);
  EXPECT_NEAR(cone->distance({0, 0, 1.5}), 0.5, 1e-15);
  EXPECT_DOUBLE_EQ(Torus(origin, z_axis, 2, 0.5).distance({2, 0, 0}), -0.5);
}

TEST(Combinations, EdgesAreExactForASquareCutCylinder) {
  // A die: block with a bore. Beyond the rim of the bore the distance is that to the rim circle.
  const auto block = std::make_shared<HalfSpace>(origin, z_axis);
  const Difference die(block, {make_cylinder(origin, z_axis, 2, {})});
  EXPECT_DOUBLE_EQ(die.distance({-1.7, 0, 0.4}), 0.5);
  EXPECT_NEAR(die.nearest({1.7, 0, 0.4}).normal.x, -0.6, 1e-14);
  EXPECT_NEAR(die.nearest({1.7, 0, 0.4}).normal.z, 0.8, 1e-14);
  EXPECT_DOUBLE_EQ(die.distance({1.7, 0, -0.4}), 0.3);
  EXPECT_NEAR(die.distance({2.1, 0, -0.4}), -0.1, 1e-14);
  // A cylinder built from an endless one and two planes equals the primitive.
  const auto cylinder = make_cylinder({0, 0, -1}, z_axis, 0.5, 2.0);
  const Intersection built({make_cylinder(origin, z_axis, 0.5, {}), std::make_shared<HalfSpace>(Vec3{0, 0, 1}, z_axis),
                            std::make_shared<HalfSpace>(Vec3{0, 0, -1}, -z_axis)});
  for (const Vec3& p : random_points(2000)) EXPECT_NEAR(built.distance(p), cylinder->distance(p), 1e-13);
  // A box from half spaces, and the complement of a union of half spaces.
  const Box box({-0.5, -0.5, -9}, {0.5, 0.5, 9});
  std::vector<ShapePointer> walls;
  for (const Vec3& n : {Vec3{1, 0, 0}, Vec3{-1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, -1, 0}})
    walls.push_back(std::make_shared<HalfSpace>(0.5 * n, n));
  const Intersection built_box(walls);
  std::vector<ShapePointer> outside;
  for (const Vec3& n : {Vec3{1, 0, 0}, Vec3{-1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, -1, 0}})
    outside.push_back(std::make_shared<HalfSpace>(0.5 * n, -n));
  const Union frame(outside);
  for (const Vec3& p : random_points(2000)) {
    EXPECT_NEAR(built_box.distance(p), box.distance(p), 1e-14);
    EXPECT_NEAR(frame.distance(p), -box.distance(p), 1e-14);
  }
}

TEST(Combinations, SignIsThatOfTheSets) {
  const Box box({-0.5, -0.5, -0.5}, {0.5, 0.5, 0.5});
  const Sphere sphere({0.3, 0.2, 0.4}, 0.5);
  const std::vector<ShapePointer> both{std::make_shared<Box>(box), std::make_shared<Sphere>(sphere)};
  const Union joined(both);
  const Intersection common(both);
  const Difference cut(both[0], {both[1]});
  for (const Vec3& p : random_points(5000)) {
    const bool in_box = box.distance(p) < 0, in_sphere = sphere.distance(p) < 0;
    EXPECT_EQ(joined.distance(p) < 0, in_box || in_sphere);
    EXPECT_EQ(common.distance(p) < 0, in_box && in_sphere);
    EXPECT_EQ(cut.distance(p) < 0, in_box && !in_sphere);
  }
}

TEST(Combinations, HalfCylinderIsRightToFirstOrder) {
  const auto half = half_cylinder();
  // Distance to the half disc of radius 0.5, x <= 0, far from the ends.
  const auto exact = [](const Vec3& p) {
    const double r = std::hypot(p.x, p.y);
    if (p.x <= 0) return std::max(r - 0.5, p.x);
    return std::abs(p.y) <= 0.5 ? p.x : std::hypot(p.x, std::abs(p.y) - 0.5);
  };
  int beyond_edge = 0;
  for (Vec3 p : random_points(20000)) {
    p.z = 0;
    const double wanted = exact(p), error = std::abs(half->distance(p) - wanted);
    EXPECT_EQ(half->distance(p) < 0, wanted < 0);
    if (wanted < 0 || wanted > 0.1) continue;
    beyond_edge += p.x > 0 && std::abs(p.y) > 0.5;
    EXPECT_LE(error, wanted * wanted / 0.5) << p.x << " " << p.y;  // relative error below distance / radius
  }
  EXPECT_GT(beyond_edge, 20);
}

TEST(Shapes, BoundsHoldTheShapeTightly) {
  std::mt19937 generator(3);
  std::uniform_real_distribution<double> along(-2, 2);
  for (const auto& shape : all_shapes()) {
    const Bounds bounds = shape->bounds();
    Bounds seen{{9, 9, 9}, {-9, -9, -9}};
    for (int n = 0; n < 4000; ++n) {
      // Feet of perpendiculars cover the surface well.
      const Vec3 p{along(generator), along(generator), along(generator)};
      const SurfacePoint at = shape->nearest(p);
      const Vec3 foot = p - at.distance * at.normal;
      if (std::abs(shape->distance(foot)) > 1e-9) continue;
      for (int i = 0; i < 3; ++i) {
        EXPECT_GE(foot[i], bounds.low[i] - 1e-9) << shape->describe();
        EXPECT_LE(foot[i], bounds.high[i] + 1e-9) << shape->describe();
        seen.low[i] = std::min(seen.low[i], foot[i]);
        seen.high[i] = std::max(seen.high[i], foot[i]);
      }
    }
    for (int i = 0; i < 3; ++i) {
      if (std::isfinite(bounds.low[i])) {
        EXPECT_LT(seen.low[i], bounds.low[i] + 0.1) << shape->describe();
      }
      if (std::isfinite(bounds.high[i])) {
        EXPECT_GT(seen.high[i], bounds.high[i] - 0.1) << shape->describe();
      }
    }
  }
  EXPECT_FALSE(std::isfinite(HalfSpace(origin, slanted).bounds().high.x));
  EXPECT_EQ(HalfSpace(Vec3{0, 0, 4}, -z_axis).bounds().low.z, 4);
}

ShapePointer shape_from(const std::string& text) {
  input::Schema schema;
  schema.variant("shape", "type", shape_schemas, "a shape");
  return make_shape(input::parse_text(text, "scene.toml", schema).table("shape"));
}

std::string error_of(const std::string& text) {
  try {
    shape_from(text);
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

TEST(ShapeInput, EveryTypeCanBeMade) {
  EXPECT_DOUBLE_EQ(
      shape_from("[shape]\ntype = 'cylinder'\nradius = '12.5 mm'\nheight = '35 mm'")->distance({0.02, 0, 0.01}),
      0.0075);
  EXPECT_DOUBLE_EQ(
      shape_from("[shape]\ntype = 'annulus'\ninner_radius = '5 mm'\nouter_radius = '12 mm'")->distance({0, 0, 99}),
      0.005);
  EXPECT_DOUBLE_EQ(shape_from("[shape]\ntype = 'sphere'\nradius = '1 m'\ncentre = ['1 m', '0 m']")->distance({3, 0, 0}),
                   1);
  EXPECT_DOUBLE_EQ(
      shape_from("[shape]\ntype = 'half_space'\npoint = ['0 m', '1 m']\nnormal = [0, 2]")->distance({3, 3, 0}), 2);
  EXPECT_DOUBLE_EQ(shape_from("[shape]\ntype = 'frustum'\nbase_radius = '1 m'\ntop_radius = '0 m'\nheight = '1 m'")
                       ->distance({0, 0, 2}),
                   1);
  EXPECT_DOUBLE_EQ(
      shape_from("[shape]\ntype = 'torus'\nring_radius = '2 m'\nsection_radius = '1 m'")->distance({0, 0, 0}), 1);
  const auto by_corners = shape_from("[shape]\ntype = 'box'\nlow = ['0 m', '0 m']\nhigh = ['2 m', '1 m']");
  const auto by_middle = shape_from("[shape]\ntype = 'box'\ncentre = ['1 m', '0.5 m']\nsize = ['2 m', '1 m']");
  for (const Vec3& p : random_points(50)) EXPECT_DOUBLE_EQ(by_corners->distance(p), by_middle->distance(p));
  const auto half = shape_from(R"toml([shape]
type = "intersection"
[[shape.shapes]]
type = "cylinder"
radius = "2 m"
[[shape.shapes]]
type = "difference"
shape = { type = "half_space", point = ["0 m", "0 m"], normal = [1, 0] }
remove = [{ type = "sphere", radius = "1 m" }]
)toml");
  EXPECT_DOUBLE_EQ(half->distance({-1.25, 0, 0}), -0.25);
  EXPECT_DOUBLE_EQ(half->distance({-0.25, 0, 0}), 0.75);
  EXPECT_DOUBLE_EQ(half->distance({1, 1.5, 0}), 1);
  const auto joined = shape_from(
      "[shape]\ntype = 'union'\nshapes = [{type = 'sphere', radius = '1 m'}, {type = 'sphere', radius = '2 m'}]");
  EXPECT_DOUBLE_EQ(joined->distance({3, 0, 0}), 1);
  EXPECT_EQ(shape_schemas().size(), 13u);
}

TEST(ShapeInput, ErrorsNameTheKey) {
  EXPECT_EQ(error_of("[shape]\ntype = 'annulus'\ninner_radius = '12 mm'\nouter_radius = '5 mm'"),
            "scene.toml:3 shape.inner_radius = \"12 mm\": must be smaller than outer_radius");
  EXPECT_EQ(error_of("[shape]\ntype = 'box'\nlow = ['0 m', '0 m']"),
            "scene.toml:1 shape: a box needs either low and high, or centre and size");
  EXPECT_EQ(error_of("[shape]\ntype = 'box'\nlow = ['0 m', '0 m']\nhigh = ['1 m', '-1 m']"),
            "scene.toml:4 shape.high = [\"1 m\", \"-1 m\"]: component y must be larger than that of low");
  EXPECT_EQ(error_of("[shape]\ntype = 'cylinder'\nradius = '1 m'\naxis = [0, 0, 0]"),
            "scene.toml:4 shape.axis = [0, 0, 0]: a direction must not be zero. Write for instance axis = [0, 0, 1]");
  EXPECT_NE(error_of("[shape]\ntype = 'cylindre'").find("Did you mean \"cylinder\"?"), std::string::npos);
}

class CurveFile {
 public:
  explicit CurveFile(const std::string& text)
      : path_(::testing::TempDir() + "curve_" + std::to_string(++count_) + "_" +
              std::to_string(reinterpret_cast<std::uintptr_t>(this)) + ".csv") {
    std::ofstream(path_) << text;
  }
  ~CurveFile() { std::remove(path_.c_str()); }
  const std::string& path() const { return path_; }
  std::string error(const std::string& unit, const std::string& column = "") const {
    try {
      TabulatedCurve::read_csv(path_, unit, column);
    } catch (const InputError& error) {
      const std::string text = error.what();
      return text.rfind(path_, 0) == 0 ? text.substr(path_.size()) : text;
    }
    return "no error";
  }

 private:
  static inline int count_ = 0;
  std::string path_;
};

TEST(TabulatedCurve, ReadsUnitsAndInterpolates) {
  const CurveFile file("# measured\ntime [min], position [mm], force [kN]\n0, 10, 1\n1, 20, 2\n\n2, 40, 3\r\n");
  const auto curve = TabulatedCurve::read_csv(file.path(), "m", "position");
  EXPECT_DOUBLE_EQ(curve.value(30), 0.015);
  EXPECT_DOUBLE_EQ(curve.value(90), 0.030);
  EXPECT_DOUBLE_EQ(curve.value(-5), 0.010);
  EXPECT_DOUBLE_EQ(curve.value(500), 0.040);
  EXPECT_NEAR(curve.slope(0), 0.010 / 60, 1e-18);
  EXPECT_NEAR(curve.slope(60), 0.020 / 60, 1e-18);
  EXPECT_EQ(curve.slope(120), 0);
  EXPECT_EQ(curve.slope(-1), 0);
  EXPECT_EQ(curve.last_time(), 120);
  const auto strict = TabulatedCurve::read_csv(file.path(), "N", "force", TabulatedCurve::Outside::Refuse);
  EXPECT_DOUBLE_EQ(strict.value(120), 3000);
  EXPECT_THROW(strict.value(121), InputError);
  EXPECT_EQ(TabulatedCurve({1}, {7}).value(3), 7);
}

TEST(TabulatedCurve, ErrorsNameTheLine) {
  EXPECT_EQ(CurveFile("time [s], position\n0, 1\n").error("m"),
            ":1: the column \"position\" has no unit. Write name [unit], for instance time [s]");
  EXPECT_EQ(CurveFile("time [s], position [kN]\n0, 1\n").error("m"),
            ":1 column position: the unit \"kN\" does not convert to m. Expected: a quantity in m");
  EXPECT_EQ(CurveFile("time [s], position [mm]\n0, 1\n1, x\n").error("m"),
            ":3 position = \"x\": not a number. Allowed: numbers with a decimal point");
  EXPECT_EQ(CurveFile("time [s], position [mm]\n0, 1\n0, 2\n").error("m"),
            ":3 time = 0 s: not later than the line before (0 s). Times must increase");
  EXPECT_EQ(CurveFile("time [s], position [mm]\n0, 1, 4\n").error("m"), ":2: 3 cells where the header names 2");
  EXPECT_EQ(CurveFile("time [s], position [mm], force [N]\n0, 1, 4\n").error("N", "forse"),
            ":1: no column \"forse\". Known: time, position, force. Did you mean \"force\"?");
  EXPECT_NE(CurveFile("").error("m").find("the table is empty"), std::string::npos);
  EXPECT_THROW(TabulatedCurve::read_csv("/no/such.csv", "m"), InputError);
}

}  // namespace
}  // namespace stirsph
