/// Meshes of rigid bodies: sizes and orientation against closed forms, searches against brute force, files, refusals.
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <numbers>
#include <random>

#include "base/error.hpp"
#include "base/timer.hpp"
#include "geometry/combinations.hpp"
#include "geometry/mesh_check.hpp"
#include "geometry/mesh_file.hpp"
#include "geometry/mesh_shape.hpp"
#include "geometry/primitives.hpp"
#include "geometry/surface_search.hpp"

namespace stirsph {
namespace {

constexpr double pi = std::numbers::pi, infinity = std::numeric_limits<double>::infinity();
const Vec3 origin{0, 0, 0}, z_axis{0, 0, 1}, slanted{1, 2, 2};

ShapeMesh meshed(const ShapePointer& shape, double size, int dimensions = 3, std::optional<Bounds> cut = {}) {
  ShapeMeshOptions options;
  options.dimensions = dimensions;
  options.sizes.near = options.sizes.far = size;
  options.cut = cut;
  ShapeMesh result = mesh_shape(shape, options);
  check_mesh(result.mesh);
  EXPECT_GT(result.worst_quality, 0.02);
  return result;
}

SimplexMesh unit_tetrahedron(double length = 0.01) {
  SimplexMesh mesh;
  mesh.nodes = {{0, 0, 0}, {length, 0, 0}, {0, length, 0}, {0, 0, length}};
  mesh.elements = {{0, 1, 2, 3}};
  extract_surface(mesh);
  return mesh;
}

template <class Action>
std::string message(Action action) {
  try {
    action();
  } catch (const InputError& error) {
    return error.what();
  }
  return "nothing was refused";
}

void expect_says(const std::string& text, const std::vector<std::string>& parts) {
  for (const auto& part : parts) EXPECT_NE(text.find(part), std::string::npos) << part << "\nin: " << text;
}

std::vector<Vec3> random_points(const Bounds& box, int count) {
  std::mt19937 generator(11);
  std::uniform_real_distribution<double> along(0, 1);
  std::vector<Vec3> points(count);
  for (auto& p : points)
    for (int i = 0; i < 3; ++i) p[i] = box.low[i] + along(generator) * (box.high[i] - box.low[i]);
  return points;
}

/// A path in the build folder that goes with the object.
struct ScratchFile {
  std::string path;
  explicit ScratchFile(const std::string& name)
      : path(std::string(STIRSPH_BINARY_DIR) + "/mesh_test_" + std::to_string(getpid()) + "_" + name) {}
  ~ScratchFile() { std::remove(path.c_str()); }
};

TEST(Element, VolumeQualityAndGradientsOfKnownOnes) {
  SimplexMesh mesh = unit_tetrahedron(0.01);
  EXPECT_NEAR(element_volume(mesh, 0), 1e-6 / 6, 1e-18);
  EXPECT_NEAR(surface_area(mesh), (1.5 + std::sqrt(3.0) / 2) * 1e-4, 1e-15);
  mesh.nodes = {{1, 1, 1}, {-1, 1, -1}, {1, -1, -1}, {-1, -1, 1}};  // regular
  EXPECT_NEAR(std::abs(element_quality(mesh, 0)), 1, 1e-12);
  SimplexMesh flat;
  flat.dim = 2;
  flat.nodes = {{0, 0, 0}, {1, 0, 0}, {0.5, std::sqrt(0.75), 0}};
  flat.elements = {{0, 1, 2, -1}};
  extract_surface(flat);
  EXPECT_NEAR(element_quality(flat, 0), 1, 1e-12);
  EXPECT_NEAR(total_volume(flat), std::sqrt(3.0) / 4, 1e-15);
  EXPECT_NEAR(surface_area(flat), 3, 1e-15);
}

TEST(Element, GradientsAreExactForLinearFields) {
  const Vec3 slope{3, -2, 5};
  for (const int dim : {2, 3}) {
    const SimplexMesh mesh = meshed(make_annulus({0, 0, -0.01}, z_axis, 0.01, 0.02, 0.02), 0.004, dim).mesh;
    for (std::size_t e = 0; e < mesh.elements.size(); ++e) {
      const auto gradients = shape_gradients(mesh, e);
      Vec3 found, sum;
      for (int i = 0; i < mesh.corners(); ++i) {
        found += (7 + dot(slope, mesh.nodes[mesh.elements[e][i]])) * gradients[i];
        sum += gradients[i];
      }
      EXPECT_LT(norm(found - (dim == 3 ? slope : Vec3{3, -2, 0})), 1e-8);
      EXPECT_LT(norm(sum), 1e-8);
    }
  }
}

TEST(ShapeMesh, OfABoxIsExactAndOutward) {
  const Vec3 low{-0.01, 0.002, 0.003}, high{0.02, 0.012, 0.008};
  const auto box = std::make_shared<Box>(low, high);
  const ShapeMesh result = meshed(box, 0.002);
  EXPECT_NEAR(total_volume(result.mesh), 0.03 * 0.01 * 0.005, 1e-15);
  EXPECT_NEAR(surface_area(result.mesh), 2 * (0.03 * 0.01 + 0.03 * 0.005 + 0.01 * 0.005), 1e-12);
  EXPECT_LT(result.surface_gap, 1e-12);
  EXPECT_EQ(result.mesh.groups.size(), 6u);
  for (std::size_t f = 0; f < result.mesh.surface.size(); ++f) {
    const Vec3 normal = normalised(facet_area_vector(result.mesh, f));
    EXPECT_GT(box->distance(facet_centroid(result.mesh, f) + 1e-5 * normal), 0);
  }
}

struct Reference {
  const char* name;
  ShapePointer shape;
  double volume, area;
  int dimensions = 3;
};

TEST(ShapeMesh, CurvedSurfacesConvergeWithOrderTwo) {
  const double r = 0.01, R = 0.02, h = 0.015;
  const auto cylinder = make_cylinder({0.001, 0, -0.4}, slanted, R, h);
  const auto annulus = make_annulus({0, 0, -0.01}, slanted, r, R, h);
  const auto tunnel = std::make_shared<Difference>(std::make_shared<Box>(Vec3{-0.02, -0.02, 0}, Vec3{0.02, 0.02, h}),
                                                   std::vector{make_cylinder(origin, z_axis, r, {})});
  const auto disc = make_cylinder(origin, z_axis, R, {}), ring = make_annulus(origin, z_axis, r, R, {});
  const std::vector<Reference> references{
      {"cylinder", cylinder, pi * R * R * h, 2 * pi * R * (R + h)},
      {"annulus", annulus, pi * (R * R - r * r) * h, 2 * pi * ((R + r) * h + R * R - r * r)},
      {"tunnel", tunnel, (0.0016 - pi * r * r) * h, 0.16 * h + 2 * 0.0016 - 2 * pi * r * r + 2 * pi * r * h},
      {"sphere", std::make_shared<Sphere>(origin, R), 4 * pi / 3 * R * R * R, 4 * pi * R * R},
      {"disc", disc, pi * R * R, 2 * pi * R, 2},
      {"ring", ring, pi * (R * R - r * r), 2 * pi * (R + r), 2}};
  for (const auto& [name, shape, volume, area, dimensions] : references) {
    double errors[2][3];
    for (const int fine : {0, 1}) {
      const double size = fine ? 0.0015 : 0.003;
      const ShapeMesh result = meshed(shape, size, dimensions);
      errors[fine][0] = std::abs(total_volume(result.mesh) / volume - 1);
      errors[fine][1] = std::abs(surface_area(result.mesh) / area - 1);
      errors[fine][2] = result.surface_gap;
      // Chords of the tightest radius in the shape, somewhat longer than asked for here and there.
      const double radius = std::string(name) == "cylinder" || std::string(name) == "disc" ? R : r;
      EXPECT_LT(result.surface_gap, 2.2 * size * size / (8 * radius)) << name;
      for (const auto& facet : result.mesh.surface)
        for (int i = 0; i < dimensions; ++i)
          EXPECT_LT(std::abs(shape->distance(result.mesh.nodes[facet[i]])), 1e-10) << name;
      for (std::size_t f = 0; f < result.mesh.surface.size(); ++f) {
        const Vec3 normal = normalised(facet_area_vector(result.mesh, f));
        EXPECT_GT(dot(shape->nearest(facet_centroid(result.mesh, f)).normal, normal), 0.9 - (dimensions == 2)) << name;
      }
    }
    std::printf("%-8s volume error %.2e -> %.2e (order %.2f), area %.2e -> %.2e (order %.2f), gap %.3g -> %.3g um\n",
                name, errors[0][0], errors[1][0], std::log2(errors[0][0] / errors[1][0]), errors[0][1], errors[1][1],
                std::log2(errors[0][1] / errors[1][1]), errors[0][2] * 1e6, errors[1][2] * 1e6);
    // What chords add at the bore of a ring they take away at its rim: nothing is left to measure an order of.
    if (errors[0][0] > 1e-4) {
      EXPECT_GT(std::log2(errors[0][0] / errors[1][0]), 1.6) << name;
    }
    EXPECT_GT(std::log2(errors[0][1] / errors[1][1]), 1.6) << name;
  }
}

TEST(ShapeMesh, CutsEndlessShapes) {
  const Bounds block{{-0.02, -0.02, -0.01}, {0.02, 0.02, 0.05}};
  const auto plate = std::make_shared<HalfSpace>(origin, z_axis);
  EXPECT_NEAR(total_volume(meshed(plate, 0.005, 3, block).mesh), 0.04 * 0.04 * 0.01, 1e-14);
  const auto tilted = std::make_shared<HalfSpace>(origin, Vec3{1, 0, 1});
  EXPECT_NEAR(total_volume(meshed(tilted, 0.005, 3, Bounds{{-0.02, -0.02, -0.02}, {0.02, 0.02, 0.02}}).mesh),
              0.5 * 0.04 * 0.04 * 0.04, 1e-13);
  const auto tube = make_annulus(origin, z_axis, 0.005, 0.01, {});
  const double exact = pi * (0.01 * 0.01 - 0.005 * 0.005) * 0.06;
  EXPECT_NEAR(total_volume(meshed(tube, 0.002, 3, block).mesh) / exact, 1, 0.02);
  const auto endless_box = std::make_shared<Box>(Vec3{-0.01, -infinity, -infinity}, Vec3{0.01, infinity, 0});
  EXPECT_NEAR(total_volume(meshed(endless_box, 0.005, 3, block).mesh), 0.02 * 0.04 * 0.01, 1e-14);
  EXPECT_NEAR(total_volume(meshed(tilted, 0.005, 2, block).mesh), 0.02 * 0.04, 1e-12);
  const auto rectangle = std::make_shared<Box>(Vec3{0, 0, -infinity}, Vec3{0.03, 0.01, infinity});
  const SimplexMesh flat = meshed(rectangle, 0.002, 2).mesh;
  EXPECT_NEAR(total_volume(flat), 0.0003, 1e-13);
  EXPECT_NEAR(surface_area(flat), 0.08, 1e-12);
  EXPECT_EQ(flat.groups.size(), 4u);
}

TEST(ShapeMesh, EveryKindOfShape) {
  const Bounds all{{-0.03, -0.03, -0.03}, {0.03, 0.03, 0.03}};
  const auto frustum = make_frustum({0, 0.001, 0}, slanted, 0.02, 0.008, 0.02);
  EXPECT_NEAR(total_volume(meshed(frustum, 0.002).mesh) / (pi * 0.02 / 3 * (4e-4 + 1.6e-4 + 0.64e-4)), 1, 0.02);
  const auto cone = make_frustum(origin, z_axis, 0.02, 0, 0.02);
  EXPECT_NEAR(total_volume(meshed(cone, 0.002).mesh) / (pi * 0.02 / 3 * 4e-4), 1, 0.02);
  const auto torus = std::make_shared<Torus>(Vec3{0.001, 0, 0}, slanted, 0.02, 0.006);
  EXPECT_NEAR(total_volume(meshed(torus, 0.0015).mesh) / (2 * pi * pi * 0.02 * 3.6e-5), 1, 0.03);
  const auto half = std::make_shared<Intersection>(std::vector<ShapePointer>{
      make_cylinder(origin, z_axis, 0.0125, 0.035), std::make_shared<HalfSpace>(origin, Vec3{1, 0, 0})});
  EXPECT_NEAR(total_volume(meshed(half, 0.002).mesh) / (pi / 2 * 0.0125 * 0.0125 * 0.035), 1, 0.01);
  // A tool: shoulder with a pin below.
  const auto tool = std::make_shared<Union>(std::vector<ShapePointer>{
      make_cylinder(origin, z_axis, 0.012, 0.02), make_cylinder({0, 0, -0.01}, z_axis, 0.004, 0.02)});
  const double tool_volume = pi * (0.012 * 0.012 * 0.02 + 0.004 * 0.004 * 0.01);
  EXPECT_NEAR(total_volume(meshed(tool, 0.0012, 3, all).mesh) / tool_volume, 1, 0.01);
}

TEST(ShapeMesh, IsGradedByDistance) {
  ShapeMeshOptions options;
  const auto billet = make_cylinder(origin, z_axis, 0.0125, 0.035);
  options.sizes = {.near = 0.0008, .far = 0.006, .growth = 0.3, .refine_at = {billet}};
  const SimplexMesh die = mesh_shape(make_annulus({0, 0, -0.01}, z_axis, 0.0125, 0.05, 0.06), options).mesh;
  check_mesh(die);
  double bore = 0, rim = 0;
  int bore_count = 0, rim_count = 0;
  for (const auto& facet : die.surface)
    for (int i = 0; i < 3; ++i) {
      const Vec3 &a = die.nodes[facet[i]], &b = die.nodes[facet[(i + 1) % 3]], middle = 0.5 * (a + b);
      const double r = std::hypot(middle.x, middle.y);
      if (std::abs(r - 0.0125) < 1e-4 && middle.z > 0 && middle.z < 0.035) bore += norm(a - b), ++bore_count;
      if (r > 0.048 && middle.z > 0 && middle.z < 0.035) rim += norm(a - b), ++rim_count;
    }
  std::printf("graded die: %zu tetrahedra, edges %.3g mm at the bore, %.3g mm at the rim\n", die.elements.size(),
              bore / bore_count * 1e3, rim / rim_count * 1e3);
  EXPECT_NEAR(bore / bore_count, 0.0008, 0.00015);
  EXPECT_NEAR(rim / rim_count, 0.006, 0.0012);
}

TEST(ShapeMesh, IsTheSameEveryTime) {
  const auto shape = make_annulus(origin, z_axis, 0.01, 0.02, 0.015);
  const SimplexMesh first = meshed(shape, 0.002).mesh, second = meshed(shape, 0.002).mesh;
  EXPECT_EQ(first.nodes, second.nodes);
  EXPECT_EQ(first.elements, second.elements);
  ShapeMeshOptions options;
  options.sizes.near = options.sizes.far = 0.002;
  options.fast = true;
  const ShapeMesh fast = mesh_shape(shape, options);
  check_mesh(fast.mesh);
  EXPECT_NEAR(total_volume(fast.mesh) / total_volume(first), 1, 1e-3);
}

TEST(ShapeMesh, RefusesWhatItCannotMesh) {
  const auto plate = std::make_shared<HalfSpace>(origin, z_axis);
  expect_says(message([&] { meshed(plate, 0.002); }), {"half space", "endless along x", "bounding box"});
  const auto apart = std::make_shared<Intersection>(std::vector<ShapePointer>{
      std::make_shared<Sphere>(origin, 0.01), std::make_shared<Sphere>(Vec3{0.1, 0, 0}, 0.01)});
  expect_says(message([&] { meshed(apart, 0.002); }), {"nothing of it"});
  const Bounds above{{-0.1, -0.1, 0.1}, {0.1, 0.1, 0.2}};
  expect_says(message([&] { meshed(plate, 0.02, 3, above); }), {"nothing of it"});
  expect_says(message([&] { meshed(plate, 0); }), {"0 < near <= far"});
  // Micrometres for millimetres must not end in a full memory; what is asked for is told from what it would make.
  ShapeMeshOptions options;
  options.sizes = {.near = 1e-6, .far = 4e-3, .growth = 0.3, .refine_at = {make_cylinder(origin, z_axis, 0.01, 0.02)}};
  expect_says(message([&] { mesh_shape(make_annulus(origin, z_axis, 0.01, 0.03, 0.02), options); }),
              {"edges of 0.001 to 4 mm", "elements. Allowed: 2e+07", "Enlarge near"});
  expect_says(message([&] { meshed(make_annulus(origin, z_axis, 0.01, 0.03, 0.02), 2e-5); }), {"Enlarge near"});
  options.dimensions = 2;
  options.sizes = {.near = 1e-7, .far = 1e-6};
  expect_says(message([&] { mesh_shape(make_annulus(origin, z_axis, 0.01, 0.03, {}), options); }), {"Enlarge near"});
}

TEST(Surface, GroupsByPlaceAndNormal) {
  SimplexMesh mesh = meshed(make_cylinder(origin, z_axis, 0.01, 0.02), 0.003).mesh;
  add_group(mesh, "top", [](const Vec3& c, const Vec3& n) { return c.z > 0.0199 && n.z > 0.9; });
  const SurfaceGroup* top = find_group(mesh, "top");
  ASSERT_NE(top, nullptr);
  double area = 0;
  for (const auto f : top->facets) area += facet_area(mesh, f);
  EXPECT_NEAR(area / (pi * 1e-4), 1, 0.03);
  EXPECT_EQ(find_group(mesh, "bottom"), nullptr);
  for (std::size_t f = 0; f < mesh.surface.size(); ++f) {
    const auto& element = mesh.elements[mesh.surface_elements[f]];
    for (const auto node : mesh.surface[f]) EXPECT_NE(std::find(element.begin(), element.end(), node), element.end());
  }
}

TEST(Search, NearestPointIsExact) {
  for (const int dim : {2, 3}) {
    const SimplexMesh mesh = meshed(make_annulus({0, 0, -0.005}, z_axis, 0.01, 0.02, 0.015), 0.003, dim).mesh;
    const SurfaceSearch search(mesh);
    std::vector<SurfaceSearch> singles;
    for (std::size_t f = 0; f < mesh.surface.size(); ++f)
      singles.emplace_back(mesh, SurfaceGroup{"one", {static_cast<std::int32_t>(f)}});
    for (Vec3 p : random_points({{-0.03, -0.03, -0.02}, {0.03, 0.03, 0.02}}, 300)) {
      if (dim == 2) p.z = 0;
      const SurfacePlace found = search.nearest(p);
      ASSERT_GE(found.facet, 0);
      Vec3 from_weights;
      double sum = 0;
      for (int i = 0; i < dim; ++i) {
        from_weights += found.weights[i] * mesh.nodes[mesh.surface[found.facet][i]];
        sum += found.weights[i];
        EXPECT_GE(found.weights[i], 0);
      }
      EXPECT_NEAR(sum, 1, 1e-14);
      EXPECT_LT(norm(from_weights - found.point), 1e-16);
      EXPECT_NEAR(norm(p - found.point), found.distance, 1e-15);
      // Brute force: every facet by itself, its point shown to be the nearest of the facet by the obtuse angles that
      // the way to it makes with the ways on to the corners.
      double least = infinity;
      for (std::size_t f = 0; f < singles.size(); ++f) {
        const SurfacePlace on_facet = singles[f].nearest(p);
        least = std::min(least, on_facet.distance);
        for (int i = 0; i < dim; ++i)
          ASSERT_LE(dot(p - on_facet.point, mesh.nodes[mesh.surface[f][i]] - on_facet.point), 1e-16);
      }
      EXPECT_NEAR(found.distance, least, 1e-15);
      const SurfacePlace close = search.nearest(p, 1.0001 * found.distance);
      EXPECT_EQ(close.facet, found.facet);
      EXPECT_EQ(search.nearest(p, 0.999 * found.distance).facet, -1);
    }
  }
}

TEST(Search, AgreesWithTheExactShapeAndIsFast) {
  const auto shape = make_annulus(origin, z_axis, 0.0125, 0.03, 0.035);
  ShapeMeshOptions options;
  options.sizes.near = options.sizes.far = 0.0012;
  options.fast = true;
  const ShapeMesh result = mesh_shape(shape, options);
  const SurfaceSearch search(result.mesh);
  const auto points = random_points({{-0.04, -0.04, -0.01}, {0.04, 0.04, 0.045}}, 40000);
  double start = wall_seconds();
  double worst = 0;
  for (const Vec3& p : points)
    worst = std::max(worst, std::abs(search.nearest(p).distance - std::abs(shape->distance(p))));
  const double anywhere = (wall_seconds() - start) / points.size();
  std::vector<Vec3> near;
  for (const Vec3& p : points)
    if (std::abs(shape->distance(p)) < 4e-4) near.push_back(p);
  start = wall_seconds();
  int hits = 0;
  for (const Vec3& p : near) hits += search.nearest(p, 5e-4).facet >= 0;
  std::printf("nearest of %zu triangles: %.2f us anywhere, %.2f us within 0.4 mm; off the exact surface by %.2g um\n",
              result.mesh.surface.size(), anywhere * 1e6, (wall_seconds() - start) / near.size() * 1e6, worst * 1e6);
  EXPECT_EQ(hits, static_cast<int>(near.size()));
  EXPECT_LT(worst, 1.01 * result.surface_gap + 1e-12);
}

TEST(Search, OnOneGroupOnly) {
  SimplexMesh mesh = meshed(std::make_shared<Box>(Vec3{0, 0, 0}, Vec3{0.01, 0.01, 0.01}), 0.003).mesh;
  add_group(mesh, "top", [](const Vec3&, const Vec3& n) { return n.z > 0.9; });
  const SurfaceSearch search(mesh, *find_group(mesh, "top"));
  EXPECT_NEAR(search.nearest({0.004, 0.005, 0.001}).distance, 0.009, 1e-12);
}

TEST(Search, FindsTheElementAroundAPoint) {
  for (const int dim : {2, 3}) {
    const auto shape = make_annulus({0, 0, -0.005}, z_axis, 0.01, 0.02, 0.015);
    const ShapeMesh result = meshed(shape, 0.003, dim);
    const ElementSearch search(result.mesh);
    int inside = 0;
    for (Vec3 p : random_points({{-0.025, -0.025, -0.007}, {0.025, 0.025, 0.012}}, 5000)) {
      if (dim == 2) p.z = 0;
      const VolumePlace found = search.find(p);
      const double distance = dim == 3 ? shape->distance(p) : make_annulus(origin, z_axis, 0.01, 0.02, {})->distance(p);
      if (distance < -result.surface_gap) {
        EXPECT_GE(found.element, 0);
      }
      if (distance > result.surface_gap) {
        EXPECT_EQ(found.element, -1);
      }
      if (found.element < 0) continue;
      ++inside;
      Vec3 back;
      for (int i = 0; i <= dim; ++i)
        back += found.weights[i] * result.mesh.nodes[result.mesh.elements[found.element][i]];
      EXPECT_LT(norm(back - p), 1e-15);
    }
    EXPECT_GT(inside, 1000);
    for (std::size_t n = 0; n < result.mesh.nodes.size(); ++n) EXPECT_GE(search.find(result.mesh.nodes[n]).element, 0);
  }
}

TEST(MeshFile, RoundTrip) {
  for (const int dim : {2, 3}) {
    SimplexMesh mesh = meshed(make_annulus({0, 0, -0.005}, z_axis, 0.01, 0.02, 0.015), 0.004, dim).mesh;
    const auto groups = mesh.groups;
    for (const auto format :
         {MeshFileFormat::Text4, MeshFileFormat::Binary4, MeshFileFormat::Text2, MeshFileFormat::Binary2}) {
      const ScratchFile file("round.msh");
      write_mesh_file(mesh, file.path, format);
      const SimplexMesh read = read_mesh_file(file.path, {.dimensions = dim});
      check_mesh(read);
      EXPECT_EQ(read.elements, mesh.elements);
      EXPECT_EQ(read.surface, mesh.surface);
      ASSERT_EQ(read.nodes.size(), mesh.nodes.size());
      for (std::size_t n = 0; n < read.nodes.size(); ++n) EXPECT_LT(norm(read.nodes[n] - mesh.nodes[n]), 1e-16);
      ASSERT_EQ(read.groups.size(), groups.size());
      for (const auto& group : groups) {
        ASSERT_NE(find_group(read, group.name), nullptr);
        EXPECT_EQ(find_group(read, group.name)->facets, group.facets);
      }
      const SimplexMesh scaled = read_mesh_file(file.path, {.dimensions = dim, .scale = 0.5});
      EXPECT_NEAR(total_volume(scaled), std::pow(0.5, dim) * total_volume(mesh), 1e-15);
    }
  }
}

/// Two tetrahedra, one at a time in a body of its own, with numbers as a user's mesher might give them; lengths in mm.
const char* two_bodies = R"($MeshFormat
2.2 0 8
$EndMeshFormat
$PhysicalNames
3
2 7 "bore"
3 1 "die"
3 2 "plate"
$EndPhysicalNames
$Nodes
5
11 0 0 0
12 10 0 0
13 0 10 0
14 0 0 10
15 10 10 10
$EndNodes
$Elements
3
100 2 2 7 1 11 12 13
101 4 2 1 1 11 12 13 14
102 4 2 2 2 12 15 13 14
$EndElements
)";

std::string read_text(const std::string& text, const MeshFileOptions& options = {}, const char* name = "given.msh") {
  const ScratchFile file(name);
  std::ofstream(file.path) << text;
  return message([&] { check_mesh(read_mesh_file(file.path, options)); });
}

std::string replaced(std::string text, const std::string& old, const std::string& by) {
  return text.replace(text.find(old), old.size(), by);
}

TEST(MeshFile, BodiesGroupsAndNumbers) {
  const ScratchFile file("bodies.msh");
  std::ofstream(file.path) << two_bodies;
  const SimplexMesh die = read_mesh_file(file.path, {.scale = 1e-3, .body = "die"});
  EXPECT_EQ(die.elements.size(), 1u);
  EXPECT_EQ(die.nodes.size(), 4u);
  EXPECT_EQ(die.element_number(0), 101);
  EXPECT_NEAR(total_volume(die), 1e-6 / 6, 1e-18);
  ASSERT_NE(find_group(die, "bore"), nullptr);
  EXPECT_NEAR(facet_area(die, find_group(die, "bore")->facets.at(0)), 0.5e-4, 1e-12);
  EXPECT_EQ(read_mesh_file(file.path).elements.size(), 2u);
  expect_says(read_text(two_bodies, {.body = "tool"}), {"given.msh", "no body called \"tool\"", "die, plate"});
}

TEST(MeshFile, RefusesBadFiles) {
  const std::string text = two_bodies;
  EXPECT_EQ(read_text(text, {.scale = 1e-3}), "nothing was refused");
  expect_says(read_text(replaced(text, "15 10 10 10", "15 10 10 1000"), {.scale = 1}), {"is the file in mm?"});
  expect_says(read_text(replaced(text, "15 10 10 10", "15 1e9 10 10"), {}), {"given.msh", "scale = 1e-3"});
  expect_says(read_text(text, {.scale = 1e-9}), {"given.msh", "give scale = 1e-3", "give scale = 1"});
  expect_says(read_text(text, {.scale = 0}), {"scale of a mesh must be > 0"});
  expect_says(read_text(replaced(text, "12 15 13 14", "15 12 13 14"), {.scale = 1e-3}),
              {"given.msh", "element 102", "nodes 15, 12, 13, 14", "inverted", "quality -"});
  expect_says(read_text(replaced(text, "15 10 10 10", "15 3.334 3.334 3.334"), {.scale = 1e-3}),
              {"element 102", "nodes 12, 15, 13, 14", "needle or sliver", "quality"});
  expect_says(read_text(replaced(text, "102 4 2 2 2 12 15 13 14", "102 4 2 2 2 12 15 13 99"), {}), {"given.msh", "99"});
  expect_says(read_text(text.substr(0, text.find("$Elements")) + "$Elements\n0\n$EndElements\n"), {"empty"});
  expect_says(read_text(text, {.dimensions = 2, .scale = 1e-3}), {"nothing was refused"});
  expect_says(read_text("solid stl\n"), {"not a mesh file", "$MeshFormat"});
  expect_says(read_text(replaced(text, "2.2 0 8", "3.0 0 8")), {"version 3. Allowed: 2.2 and 4.1"});
  expect_says(read_text(text, {}, "mesh.geo"), {"must end in .msh"});
  expect_says(message([] { read_mesh_file("/nowhere/die.msh"); }), {"/nowhere/die.msh", "cannot be opened"});
  std::string quadratic = text;
  quadratic.insert(quadratic.find("$EndNodes"), "16 5 0 0\n17 5 5 0\n18 0 5 0\n19 0 0 5\n20 0 5 5\n21 5 0 5\n");
  quadratic = replaced(replaced(quadratic, "\n5\n11", "\n11\n11"), "101 4 2 1 1 11 12 13 14",
                       "101 11 2 1 1 11 12 13 14 16 17 18 19 20 21");
  expect_says(read_text(quadratic), {"element 101 is a", "Tetrahedron 10", "linear tetrahedra"});
  expect_says(read_text(replaced(text, "15 10 10 10", "15 0 0 0.00000000001"), {.scale = 1e-3}), {"element 102"});
}

TEST(MeshCheck, RefusesEachFaultByName) {
  SimplexMesh empty;
  empty.source = "die.msh";
  expect_says(message([&] { check_mesh(empty); }), {"die.msh", "empty", "no tetrahedra"});

  SimplexMesh open = unit_tetrahedron();
  open.surface.pop_back();
  expect_says(message([&] { check_mesh(open); }), {"surface is open at the edge between nodes 1 and 3"});

  SimplexMesh split = unit_tetrahedron();  // a neighbour that only seems to share a face
  split.nodes.insert(split.nodes.end(), {{0.01, 0, 0}, {0.01, 0.01, 0.01}, {0, 0.01, 0}, {0, 0, 0.01}});
  split.elements.push_back({4, 5, 6, 7});
  extract_surface(split);
  expect_says(message([&] { check_mesh(split); }), {"nodes 4 and 8", "(0, 0, 0.01) m", "no heat would flow"});
  for (std::size_t n = 4; n < split.nodes.size(); ++n) split.nodes[n] += Vec3{1e-9, -2e-9, 1e-9};  // seven digits
  expect_says(message([&] { check_mesh(split); }), {"are both at", "no heat would flow"});

  SimplexMesh overlap = unit_tetrahedron();
  overlap.nodes.push_back({0.02, 0.02, 0.02});
  overlap.elements.insert(overlap.elements.end(), {{1, 4, 2, 3}, {1, 4, 2, 3}});
  expect_says(message([&] { extract_surface(overlap); }), {"elements 1, 2 and 3", "share one face", "overlap"});

  EXPECT_EQ(message([&] { check_mesh(unit_tetrahedron(9)); }), "nothing was refused");
  expect_says(message([&] { check_mesh(unit_tetrahedron(50)); }), {"50 m long", "in mm? give scale = 1e-3"});
  SimplexMesh flat = unit_tetrahedron();
  flat.nodes[3] = {0.002, 0.002, 0.00001};
  expect_says(message([&] { check_mesh(flat); }), {"element 1 (nodes 1, 2, 3, 4", "needle or sliver"});
  flat.nodes[3].z = -0.01;
  expect_says(message([&] { check_mesh(flat); }), {"element 1", "inverted"});
}

TEST(MeshFile, PaperScaleInUnderAMinute) {
  // Die, plate and tool with about 380,000 tetrahedra of about 1.7 mm.
  const auto billet = make_cylinder(origin, z_axis, 0.0125, 0.035);
  ShapeMeshOptions options;
  options.sizes = {.near = 0.0011, .far = 0.00145, .growth = 0.1, .refine_at = {billet}};
  const double start = wall_seconds();
  const ShapePointer die = make_annulus(origin, z_axis, 0.0125, 0.035, 0.035),
                     tool = make_cylinder({0, 0, 0.035}, z_axis, 0.0125, 0.06);
  const auto plate = std::make_shared<HalfSpace>(origin, z_axis);
  std::vector<ShapeMesh> meshes{mesh_shape(die, options), mesh_shape(tool, options)};
  options.cut = Bounds{{-0.04, -0.04, -0.015}, {0.04, 0.04, 0.01}};
  meshes.push_back(mesh_shape(plate, options));
  const double meshed_after = wall_seconds();
  options.cut.reset();
  options.fast = true;
  const ShapeMesh fast = mesh_shape(die, options);
  std::printf("the die alone: %zu tetrahedra in %.2f s, worst quality %.3f; by the fast mesher %zu in %.2f s, %.3f\n",
              meshes[0].mesh.elements.size(), meshes[0].meshing_seconds, meshes[0].worst_quality,
              fast.mesh.elements.size(), fast.meshing_seconds, fast.worst_quality);
  const double fast_after = wall_seconds();
  std::size_t elements = 0, nodes = 0;
  double worst = 1, volume = 0;
  for (const auto& [mesh, quality, gap, seconds] : meshes) {
    check_mesh(mesh);
    elements += mesh.elements.size();
    nodes += mesh.nodes.size();
    volume += total_volume(mesh);
    worst = std::min(worst, quality);
  }
  const double checked_after = wall_seconds();
  const ScratchFile file("large.msh");
  write_mesh_file(meshes[0].mesh, file.path);
  const double written_after = wall_seconds();
  const SimplexMesh read = read_mesh_file(file.path);
  const double read_after = wall_seconds();
  const SurfaceSearch search(read);
  const ElementSearch elements_of(read);
  std::printf(
      "%zu tetrahedra, %zu nodes, edge of a regular one of mean volume %.2f mm, worst quality %.3f: meshed in %.2f s, "
      "checked in %.2f s; the die's %zu written in %.2f s, read in %.2f s, search trees built in %.2f s\n",
      elements, nodes, std::cbrt(volume / elements * 6 * std::sqrt(2.0)) * 1e3, worst, meshed_after - start,
      checked_after - fast_after, read.elements.size(), written_after - checked_after, read_after - written_after,
      wall_seconds() - read_after);
  EXPECT_GT(elements, 300000u);
  EXPECT_LT(checked_after - start, 60);
  EXPECT_EQ(read.elements, meshes[0].mesh.elements);
}

}  // namespace
}  // namespace stirsph
