/// Solids of revolution with fillets: distance against sampled surfaces, gradients, signs, meshes, refusals.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <initializer_list>
#include <numbers>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "base/error.hpp"
#include "geometry/mesh_check.hpp"
#include "geometry/mesh_shape.hpp"
#include "geometry/revolved_profile.hpp"
#include "geometry/shape_input.hpp"
#include "support/distance_gradient.hpp"

namespace stirsph {
namespace {

constexpr double pi = std::numbers::pi, degree = pi / 180;
const Vec3 origin{0, 0, 0}, z_axis{0, 0, 1}, slanted{1, 2, 2};

using Vertices = std::vector<RevolvedProfile::Vertex>;

ShapePointer profile(const Vertices& vertices, const Vec3& base = origin, const Vec3& axis = z_axis) {
  return std::make_shared<RevolvedProfile>(base, axis, vertices, "profile");
}

struct Named {
  const char* name;
  ShapePointer shape;
};

/// About 1 m in size, with every kind of corner: outer and inner, sharp and rounded, on and off the axis, given either
/// way round, and an arc that turns back in z.
std::vector<Named> shapes() {
  const Vertices stepped{{0, -0.5}, {0.8, -0.5, 0.2}, {0.8, -0.1, 0.05}, {0.4, -0.1, 0.15}, {0.4, 0.6}, {0, 0.6}};
  const Vertices backwards(stepped.rbegin(), stepped.rend());
  return {
      {"stepped", profile(stepped)},
      {"stepped, slanted, backwards", profile(backwards, {0.1, 0, -0.1}, slanted)},
      {"ring with a groove",
       profile(
           {{0.3, -0.4}, {0.9, -0.4, 0.1}, {0.9, 0, 0.1}, {0.6, 0.1, 0.05}, {0.9, 0.2}, {0.9, 0.5}, {0.5, 0.5, 0.1}},
           {0, 0.1, 0}, slanted)},
      {"pointed tip on the axis", profile({{0, -0.6}, {0.7, 0.1, 0.1}, {0.5, 0.5}, {0, 0.5}})},
      {"sharp wedge whose fillet turns back", profile({{0.2, -0.5}, {0.9, 0.1, 0.1}, {0.2, 0.2}})},
      {"tool", make_tool({0, 0, -0.5}, z_axis, 0.8, 0.3, 0.2, 1, 0.1)},
      {"ball nose", make_tool({0, 0, -0.5}, slanted, 0.5, 0.5, 0.2, 1, 0.5)},
      {"die", make_die({0, 0, -0.5}, slanted, 0.4, 0.9, 1, 10 * degree, 0.1)},
      {"closing die", make_die({0, 0, -0.5}, z_axis, 0.4, 0.9, 1, -10 * degree, 0.1)}};
}

std::vector<Vec3> random_points(int count) { return testing::random_points(count, 1.2, 11); }

TEST(RevolvedProfile, NormalIsTheUnitGradientOfTheDistance) {
  for (const auto& [name, shape] : shapes()) {
    int smooth = 0;
    for (const Vec3& p : random_points(3000)) {
      const SurfacePoint at = shape->nearest(p);
      EXPECT_NEAR(norm(at.normal), 1, 1e-12) << name;
      const auto gradient = testing::distance_gradient(*shape, p);
      if (!gradient) continue;
      ++smooth;
      EXPECT_LT(norm(*gradient - at.normal), 1e-3) << name << " at " << p.x << " " << p.y << " " << p.z;
      EXPECT_NEAR(norm(*gradient), 1, 1e-3) << name;
    }
    EXPECT_GT(smooth, 2800) << name;
  }
}

/// The surface sampled densely from the edges alone: no point of it is nearer than the distance says, and one is as
/// near.
TEST(RevolvedProfile, DistanceIsThatToTheSampledSurface) {
  constexpr int per_edge = 400;
  for (const auto& [name, shape] : shapes()) {
    const auto& solid = dynamic_cast<const RevolvedProfile&>(*shape);
    std::vector<std::pair<double, double>> samples;
    double spacing = 0;
    for (const auto& e : solid.edges()) {
      if (!e.is_surface) continue;
      const double first = std::atan2(e.start_z - e.centre_z, e.start_r - e.centre_r);
      const double half = std::acos(e.cos_half), middle = std::atan2(e.middle_z, e.middle_r);
      for (int k = 0; k <= per_edge; ++k) {
        const double share = static_cast<double>(k) / per_edge;
        if (e.radius == 0) {
          samples.push_back({e.start_r + share * (e.end_r - e.start_r), e.start_z + share * (e.end_z - e.start_z)});
        } else {
          const double angle = middle + (2 * share - 1) * half;
          samples.push_back({e.centre_r + e.radius * std::cos(angle), e.centre_z + e.radius * std::sin(angle)});
        }
      }
      if (e.radius > 0) {
        EXPECT_NEAR(std::cos(first - middle), e.cos_half, 1e-9) << name;
      }
      spacing = std::max(spacing, (e.radius > 0 ? 2 * half * e.radius : e.length) / per_edge);
    }
    for (const Vec3& p : random_points(1500)) {
      const Vec3 offset = p - solid.base();
      const double z = dot(offset, solid.axis()), r = norm(offset - z * solid.axis());
      double nearest = 1e9;
      for (const auto& [sr, sz] : samples) nearest = std::min(nearest, std::hypot(sr - r, sz - z));
      const double distance = std::abs(shape->distance(p));
      EXPECT_LE(distance, nearest + 1e-12) << name;
      EXPECT_GE(distance, nearest - 0.5 * spacing) << name;
    }
  }
}

TEST(RevolvedProfile, FootOfThePerpendicularLiesOnTheSurface) {
  for (const auto& [name, shape] : shapes())
    for (const Vec3& p : random_points(2000)) {
      const SurfacePoint at = shape->nearest(p);
      EXPECT_NEAR(shape->distance(p - at.distance * at.normal), 0, 1e-12) << name;
    }
}

/// Inside by the winding number of the finely broken profile, which knows nothing of crossings and arcs.
TEST(RevolvedProfile, SignIsThatOfTheWindingNumber) {
  for (const auto& [name, shape] : shapes()) {
    const auto& solid = dynamic_cast<const RevolvedProfile&>(*shape);
    int inside = 0;
    for (const Vec3& p : random_points(3000)) {
      const Vec3 offset = p - solid.base();
      const double z = dot(offset, solid.axis()), r = norm(offset - z * solid.axis());
      double winding = 0;
      const auto walk = [&](double ar, double az, double br, double bz) {
        winding += std::atan2((ar - r) * (bz - z) - (az - z) * (br - r), (ar - r) * (br - r) + (az - z) * (bz - z));
      };
      for (const auto& e : solid.edges()) {
        if (e.radius == 0) {
          walk(e.start_r, e.start_z, e.end_r, e.end_z);
          continue;
        }
        const double half = std::acos(e.cos_half), middle = std::atan2(e.middle_z, e.middle_r);
        double ar = e.start_r, az = e.start_z;
        for (int k = 1; k <= 200; ++k) {
          const double angle = middle + e.outward * (k / 100.0 - 1) * half;
          const double br = e.centre_r + e.radius * std::cos(angle), bz = e.centre_z + e.radius * std::sin(angle);
          walk(ar, az, br, bz);
          ar = br, az = bz;
        }
      }
      const double distance = shape->distance(p);
      if (std::abs(distance) < 1e-5) continue;  // within the sag of the broken arcs
      EXPECT_EQ(distance<0, winding> pi) << name << " at r " << r << " z " << z;
      inside += distance < 0;
    }
    EXPECT_GT(inside, 50) << name;
  }
}

TEST(RevolvedProfile, KnownDistances) {
  // An 11 mm tool, 2 mm land, 0.5 mm relief, 0.4 mm edge fillet.
  const auto tool = make_tool(origin, z_axis, 11e-3, 2e-3, 0.5e-3, 40e-3, 0.4e-3);
  EXPECT_NEAR(tool->distance({0, 0, -1e-3}), 1e-3, 1e-15);
  EXPECT_NEAR(tool->distance({12e-3, 0, 1e-3}), 1e-3, 1e-15);
  EXPECT_NEAR(tool->distance({11e-3, 0, 3e-3}), 0.5e-3, 1e-15);       // beside the relieved shank
  EXPECT_NEAR(tool->distance({10.4e-3, 0, 2.2e-3}), -0.1e-3, 1e-15);  // inside it
  EXPECT_NEAR(tool->distance({10.9e-3, 0, 2.3e-3}), 0.3e-3, 1e-15);   // above the land
  const double corner = 0.4e-3 * (std::sqrt(2.0) - 1);                // the fillet cuts this off the sharp edge
  EXPECT_NEAR(tool->distance({11e-3, 0, 0}), corner, 1e-15);
  const Vec3 normal = tool->nearest({11e-3, 0, 0}).normal;
  EXPECT_NEAR(normal.x, std::sqrt(0.5), 1e-12);
  EXPECT_NEAR(normal.z, -std::sqrt(0.5), 1e-12);
  // Inside the concave corner between land and shank the distance is to the corner itself.
  EXPECT_NEAR(tool->distance({10.2e-3, 0, 1.6e-3}), -0.5e-3, 1e-15);
  // A bore of 12.5 mm that opens by 1 degree: the distance to the slanted wall is less by its cosine.
  const auto die = make_die(origin, z_axis, 12.5e-3, 30e-3, 35e-3, degree, 0);
  EXPECT_NEAR(die->distance({12.5e-3, 0, 20e-3}), 20e-3 * std::tan(degree) * std::cos(degree), 1e-15);
  EXPECT_LT(die->distance({13e-3, 0, 10e-3}), 0);
  EXPECT_GT(die->distance({0, 0, 10e-3}), 12e-3);
  // A ball nose: the sphere's distance from its centre and around it, up to the axis.
  const auto ball = make_tool(origin, z_axis, 5e-3, 5e-3, 0, 20e-3, 5e-3);
  EXPECT_NEAR(ball->distance({0, 0, 5e-3}), -5e-3, 1e-15);
  EXPECT_NEAR(ball->distance({0, 0, -1e-3}), 1e-3, 1e-15);
  EXPECT_NEAR(ball->distance({3e-3, 0, 1e-3}), 0, 1e-15);
  EXPECT_NEAR(ball->nearest({0, 0, -1e-3}).normal.z, -1, 1e-12);
  // A cone's tip on the axis.
  EXPECT_NEAR(profile({{0, 0}, {1, 1}, {0, 1}})->nearest({0, 0, -0.5}).normal.z, -1, 1e-12);
}

TEST(RevolvedProfile, BoundsAreThoseOfTheArcs) {
  const Bounds ball = make_tool(origin, slanted, 0.5, 0.5, 0, 1, 0.5)->bounds();
  for (int i = 0; i < 3; ++i) {  // sphere about the point at 0.5 along the axis, rim of the shank's end at 1
    const double a = normalised(slanted)[i];
    EXPECT_NEAR(ball.low[i], 0.5 * a - 0.5, 1e-12);
    EXPECT_NEAR(ball.high[i], a + 0.5 * std::sqrt(1 - a * a), 1e-12);
  }
  for (const auto& [name, shape] : shapes()) {
    const Bounds bounds = shape->bounds();
    Bounds seen{{9, 9, 9}, {-9, -9, -9}};
    for (Vec3 p : random_points(20000)) {
      p = 1.5 * p;
      const SurfacePoint at = shape->nearest(p);
      const Vec3 foot = p - at.distance * at.normal;
      for (int i = 0; i < 3; ++i) {
        EXPECT_GE(foot[i], bounds.low[i] - 1e-9) << name;
        EXPECT_LE(foot[i], bounds.high[i] + 1e-9) << name;
        seen.low[i] = std::min(seen.low[i], foot[i]);
        seen.high[i] = std::max(seen.high[i], foot[i]);
      }
    }
    for (int i = 0; i < 3; ++i) {
      EXPECT_LT(seen.low[i], bounds.low[i] + 0.02) << name;
      EXPECT_GT(seen.high[i], bounds.high[i] - 0.02) << name;
    }
  }
}

TEST(RevolvedProfile, IsMeshedWithItsFillets) {
  const double R = 11e-3, land = 4e-3, relief = 2e-3, height = 12e-3, f = 2e-3;
  const auto tool = make_tool({0, 0, 1e-3}, z_axis, R, land, relief, height, f);
  const ShapeMesh meshed = mesh_shape(tool, {.sizes = {.near = 1.2e-3, .far = 1.2e-3}});
  check_mesh(meshed.mesh);
  // The fillet cuts off what lies between a square of side f and a quarter disc; turned about the axis by Pappus' rule.
  const double cut = f * f * (1 - pi / 4), from_arc_centre = f / 6 / (1 - pi / 4);
  const double volume =
      pi * (R * R * land + (R - relief) * (R - relief) * (height - land)) - 2 * pi * (R - f + from_arc_centre) * cut;
  EXPECT_NEAR(total_volume(meshed.mesh) / volume, 1, 0.01);
  EXPECT_LT(meshed.surface_gap, 0.12e-3);  // s^2/(8 R) on the fillet: 0.09 mm
  EXPECT_GT(meshed.worst_quality, 0.05);
  for (const Vec3& node : meshed.mesh.nodes) EXPECT_LT(tool->distance(node), 1e-9);

  const auto die = make_die(origin, z_axis, 12e-3, 20e-3, 15e-3, 5 * degree, 1e-3);
  const ShapeMesh ring = mesh_shape(die, {.sizes = {.near = 1.5e-3, .far = 1.5e-3}});
  check_mesh(ring.mesh);
  EXPECT_LT(ring.surface_gap, 0.3e-3);
  for (const Vec3& node : ring.mesh.nodes) EXPECT_LT(die->distance(node), 1e-9);
}

std::string complaint(const std::string& keys) {
  input::Schema schema;
  schema.variant("shape", "type", shape_schemas, "a shape");
  try {
    make_shape(input::parse_text("[shape]\n" + keys, "scene.toml", schema).table("shape"));
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

std::string points(const std::vector<std::array<double, 3>>& vertices) {
  std::string text = "type = 'profile'\npoints = [";
  for (const auto& v : vertices)
    text += "{r = '" + std::to_string(v[0]) + " mm', z = '" + std::to_string(v[1]) + " mm', fillet = '" +
            std::to_string(v[2]) + " mm'}, ";
  return text + "]\n";
}

void expect_says(const std::string& message, std::initializer_list<const char*> parts) {
  for (const char* part : parts) EXPECT_NE(message.find(part), std::string::npos) << part << " is not in " << message;
}

TEST(RevolvedProfile, ImpossibleProfilesNameTheVertex) {
  EXPECT_EQ(complaint(points({{0, 0, 0}, {4, 0, 1}, {4, 5, 0}, {0, 5, 0}})), "no error");
  expect_says(complaint(points({{0, 0, 0}, {4, 5, 0}, {4, 0, 0}, {0, 5, 0}})),
              {"shape.points", "vertex 0", "vertex 2", "cross"});
  expect_says(complaint(points({{0, 0, 0}, {4, 0, 3}, {4, 2, 0}, {0, 2, 0}})),
              {"vertex 1 (r = 4 mm, z = 0 mm)", "fillet of 3 mm is too large", "a line of 2 mm"});
  expect_says(complaint(points({{0, 0, 0}, {4, 0, 1.5}, {4, 2, 1}, {0, 2, 0}})),
              {"vertex 1", "2.5 mm of a line of 2 mm"});
  expect_says(complaint(points({{0, 0, 1}, {4, 0, 0}, {4, 2, 0}, {0, 2, 0}})), {"vertex 0", "on the axis"});
  expect_says(complaint(points({{1, 0, 0}, {4, 0, 0}, {4, 0, 0}, {1, 2, 0}})), {"vertex 1", "same place"});
  expect_says(complaint(points({{1, 0, 0}, {4, 0, 0}, {2, 0, 0}})), {"vertex", "lie on each other"});
  expect_says(complaint(points({{1, 0, 0}, {4, 0, 0}, {4, 4, 0}, {2, 0, 0}, {1, 4, 0}})), {"vertex 0", "touch"});
  // A narrow slot that reaches into the corner which the fillet cuts off.
  expect_says(
      complaint(points({{0, 0, 0}, {10, 0, 8}, {10, 10, 0}, {9.4, 10, 0}, {9.2, 1, 0}, {9, 10, 0}, {0, 10, 0}})),
      {"vertex 1", "reaches the line from vertex"});
  expect_says(complaint("type = 'profile'\npoints = [{r='0 m', z='0 m'}, {r='1 m', z='0 m'}]"), {"points", "3"});
  expect_says(complaint("type = 'profile'\npoints = [{r='-1 m', z='0 m'}, {r='1 m', z='0 m'}, {r='1 m', z='1 m'}]"),
              {"points[0].r = \"-1 m\"", ">= 0"});
  EXPECT_THROW(profile({{-1, 0}, {1, 0}, {1, 1}}), InputError);
}

TEST(RevolvedProfile, ImpossibleToolsAndDiesNameTheKey) {
  const std::string tool = "type = 'tool'\nradius = '11 mm'\nheight = '40 mm'\n";
  EXPECT_EQ(complaint(tool + "land = '2 mm'\nrelief = '0.5 mm'\nedge_fillet = '0.3 mm'"), "no error");
  expect_says(complaint(tool + "land = '41 mm'"), {"shape.land = \"41 mm\"", "40 mm"});
  expect_says(complaint(tool + "relief = '0.5 mm'"), {"shape.relief", "land = \"2 mm\""});
  expect_says(complaint(tool + "land = '2 mm'\nrelief = '11 mm'"),
              {"shape.relief = \"11 mm\"", "smaller than the radius"});
  expect_says(complaint(tool + "land = '2 mm'\nedge_fillet = '3 mm'"), {"shape.edge_fillet = \"3 mm\"", "up to 2 mm"});
  const std::string die = "type = 'die'\ninner_radius = '12 mm'\nouter_radius = '20 mm'\nheight = '30 mm'\n";
  EXPECT_EQ(complaint(die + "taper = '0.5 deg'\nedge_fillet = '1 mm'"), "no error");
  expect_says(complaint(die + "taper = '30 deg'"), {"shape.taper = \"30 deg\"", "29.3", "20 mm"});
  expect_says(complaint(die + "taper = '-30 deg'"), {"shape.taper", "-5.3"});
  expect_says(complaint(die + "edge_fillet = '9 mm'"), {"shape.edge_fillet = \"9 mm\"", "too large"});
  expect_says(complaint("type = 'die'\ninner_radius = '12 mm'\nouter_radius = '2 mm'\nheight = '30 mm'"),
              {"shape.inner_radius"});
}

}  // namespace
}  // namespace stirsph
