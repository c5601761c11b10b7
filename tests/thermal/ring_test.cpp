/// Heat in the axisymmetric space: rings of particles at an axis with and without the mirror images that the mechanics
/// puts beyond it, areas of rings, sections of meshes.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <map>
#include <numbers>
#include <numeric>
#include <vector>

#include "geometry/combinations.hpp"
#include "geometry/mesh_file.hpp"
#include "geometry/revolved_profile.hpp"
#include "support/rigid_bodies.hpp"
#include "thermal/conduction.hpp"
#include "thermal/contact_area.hpp"
#include "thermal/free_surface.hpp"
#include "thermal/interface_search.hpp"

namespace stirsph::testing {
namespace {

constexpr double pi = std::numbers::pi, dx = 0.5 * mm;

/// Rings on a square lattice over inner <= r < outer (in spacings) and `layers` above z = 0, on this rank alone.
/// `images`: with halo copies of all rings within four spacings of the axis, beyond it.
class Rings {
 public:
  Rings(int inner, int outer, int layers, bool images) : particles(layout_of<AxisymmetricSwirl>()) {
    HeatSolver::add_fields(particles);
    for (const FieldInfo* info : {&field::id, &field::body}) particles.add(*info);
    const auto count = static_cast<std::size_t>((outer - inner) * layers);
    particles.resize_owned(count);
    const auto place = [&](std::size_t i, double r, double z) {
      particles.component(field::position, 0)[i] = r;
      particles.component(field::position, 1)[i] = z;
      particles[field::volume][i] = 2 * pi * std::abs(r) * dx * dx;
      particles[field::mass][i] = 2785 * particles[field::volume][i];
      particles[field::smoothing_length][i] = 1.3 * dx;
      particles[field::conductivity][i] = 188;
      particles[field::temperature][i] = 300 + 1e6 * z * z + 3e5 * r * (r + z);
    };
    for (std::size_t i = 0; i < count; ++i) {
      const int column = inner + static_cast<int>(i) % (outer - inner), row = static_cast<int>(i) / (outer - inner);
      place(i, (column + 0.5) * dx, (row + 0.5) * dx);
      particles[field::id][i] = static_cast<double>(i);
    }
    if (images) {
      std::vector<std::size_t> near;
      for (std::size_t i = 0; i < count; ++i)
        if (particles.component(field::position, 0)[i] < 4 * dx) near.push_back(i);
      particles.resize_halo(near.size());
      for (std::size_t k = 0; k < near.size(); ++k)
        place(count + k, -particles.component(field::position, 0)[near[k]],
              particles.component(field::position, 1)[near[k]]);
    }
    pairs.build(particles, 2.6 * dx * (1 + 1e-9));
  }

  HeatGraph graph() {
    HeatGraph result;
    const Kernel kernel = CubicSpline{};
    result.build(particles, pairs,
                 {kernel, lattice_conduction_factor(kernel, 2, 1.3), lattice_kernel_sum(kernel, 2, 1.3)});
    return result;
  }

  ParticleSet particles;
  PairList pairs;
};

TEST(RingConduction, MirrorImagesChangeNothing) {
  Rings without(0, 9, 12, false), with(0, 9, 12, true);
  const HeatGraph a = without.graph(), b = with.graph();
  ASSERT_GT(with.particles.total(), with.particles.owned());
  for (std::size_t i = 0; i < without.particles.owned(); ++i) {
    ASSERT_EQ(a.neighbours(i).size(), b.neighbours(i).size());
    for (std::size_t k = 0; k < a.neighbours(i).size(); ++k) {
      EXPECT_EQ(a.neighbours(i)[k], b.neighbours(i)[k]);
      EXPECT_EQ(a.factors(i)[k], b.factors(i)[k]);
    }
    EXPECT_DOUBLE_EQ(without.particles[field::conduction_correction][i],
                     with.particles[field::conduction_correction][i]);
  }
}

TEST(RingConduction, TheAxisIsNoSurface) {
  Rings rings(0, 9, 12, false);
  rings.graph();
  const auto correction = rings.particles[field::conduction_correction];
  for (std::size_t i = 0; i < rings.particles.owned(); ++i) {
    const Vec3 x = rings.particles.vector_at(field::position, i);
    if (x.x < 6 * dx && x.z > 3 * dx && x.z < 9 * dx) {
      EXPECT_NEAR(correction[i], 1, 1e-12) << x.x;
    } else if (x.x > 8 * dx) {  // the mantle is one
      EXPECT_GT(correction[i], 1.2);
    }
  }
}

TEST(RingConduction, LinksAreSymmetricAndNotNegative) {
  Rings rings(0, 7, 9, true);
  const HeatGraph graph = rings.graph();
  const LinkEnds ends(rings.particles);
  std::map<std::pair<std::size_t, std::size_t>, double> links;
  for (std::size_t i = 0; i < graph.particles(); ++i)
    for (std::size_t k = 0; k < graph.neighbours(i).size(); ++k) {
      const auto j = static_cast<std::size_t>(graph.neighbours(i)[k]);
      ASSERT_LT(j, rings.particles.owned()) << "an image has no links";
      links[{i, j}] = ends.conductance(i, j, graph.factors(i)[k]);
      EXPECT_GE((links[{i, j}]), 0);
    }
  for (const auto& [ends_of, value] : links) EXPECT_EQ(value, (links.at({ends_of.second, ends_of.first})));
  const std::vector<double> power = conduction_power(rings.particles, graph);
  double scale = 0;
  for (const double p : power) scale += std::abs(p);
  EXPECT_GT(scale, 0);
  EXPECT_NEAR(std::accumulate(power.begin(), power.end(), 0.0), 0, 1e-13 * scale);
}

/// div(k grad T) of T = r^2, z^2 and ln r is 4 k, 2 k and 0: per ring where nothing is cut off, and the flow through a
/// cylinder around the axis, where single rings deviate.
TEST(RingConduction, Laplacian) {
  Rings rings(0, 16, 18, false);
  const HeatGraph graph = rings.graph();
  const auto volume = rings.particles[field::volume];
  const auto power_of = [&](auto temperature) {
    for (std::size_t i = 0; i < rings.particles.owned(); ++i) {
      const Vec3 x = rings.particles.vector_at(field::position, i);
      rings.particles[field::temperature][i] = temperature(x.x, x.z);
    }
    return conduction_power(rings.particles, graph);
  };
  const std::vector<double> square = power_of([](double r, double) { return 1e6 * r * r; }),
                            axial = power_of([](double, double z) { return 1e6 * z * z; }),
                            log = power_of([](double r, double) { return 100 * std::log(r / dx); });
  double inflow = 0, content = 0, along = 0;
  for (std::size_t i = 0; i < rings.particles.owned(); ++i) {
    const Vec3 x = rings.particles.vector_at(field::position, i);
    if (x.z < 6 * dx || x.z > 12 * dx) continue;
    if (x.x > 3 * dx && x.x < 10 * dx) {
      EXPECT_NEAR(square[i] / volume[i] / (4e6 * 188), 1, 1e-12);
      EXPECT_NEAR(axial[i] / volume[i] / (2e6 * 188), 1, 1e-12);
      EXPECT_NEAR(log[i] / volume[i] * x.x * x.x / (100 * 188), 0, 0.06);  // fourth differences of ln r: 6/4! (dx/r)^2
    }
    if (x.x < 9 * dx) {
      inflow += square[i];
      along += axial[i];
      content += volume[i];
    }
  }
  // Without links to images single rings next to the axis err; their sum is off by 0.1 of a spacing in the square of
  // the radius, whatever the radius, and not at all along the axis.
  std::printf("flow into a cylinder of 9 spacings: %+.3f %%\n", 100 * (inflow / content / (4e6 * 188) - 1));
  EXPECT_NEAR(inflow / content / (4e6 * 188), 1, 3e-3);
  EXPECT_NEAR(along / content / (2e6 * 188), 1, 1e-12);
}

double sum(const std::vector<double>& values) { return std::accumulate(values.begin(), values.end(), 0.0); }

TEST(RingAreas, FreeSurfaceOfADiscAndATube) {
  for (const bool images : {false, true}) {
    Rings disc(0, 20, 12, images);
    disc.graph();
    const std::vector<double> areas = free_surface_areas(disc.particles, disc.pairs, {});
    const double radius = 20 * dx, height = 12 * dx;
    double bottom = 0, mantle = 0, inside = 0;
    for (std::size_t i = 0; i < areas.size(); ++i) {
      const Vec3 x = disc.particles.vector_at(field::position, i);
      if (x.z < dx && x.x < radius - 2 * dx) bottom += areas[i];
      if (x.x > radius - dx && x.z > 2 * dx && x.z < height - 2 * dx) mantle += areas[i];
      if (x.x < radius - 2 * dx && x.z > 2 * dx && x.z < height - 2 * dx) inside += areas[i];
    }
    EXPECT_NEAR(bottom / (pi * std::pow(radius - 2 * dx, 2)), 1, 1e-3);
    EXPECT_NEAR(mantle / (2 * pi * radius * (height - 4 * dx)), 1, 1e-3);
    EXPECT_EQ(inside, 0);
    const double exact = 2 * pi * radius * (radius + height);
    std::printf("free surface of a disc of 20 by 12 spacings: %+.2f %%\n", 100 * (sum(areas) / exact - 1));
    EXPECT_NEAR(sum(areas) / exact, 1, 0.03);  // edges
  }
  Rings tube(8, 14, 12, false);
  tube.graph();
  double bore = 0;
  const std::vector<double> areas = free_surface_areas(tube.particles, tube.pairs, {});
  for (std::size_t i = 0; i < areas.size(); ++i) {
    const Vec3 x = tube.particles.vector_at(field::position, i);
    if (x.x < 9 * dx && x.z > 2 * dx && x.z < 10 * dx) bore += areas[i];
  }
  EXPECT_NEAR(bore / (2 * pi * 8 * dx * 8 * dx), 1, 1e-3);
}

/// Rigid bodies around a disc of particles: below, around, and a bore filled by it.
struct Surroundings {
  std::vector<RigidBody> rigids;
  std::vector<RigidHeat> heat;
  Surroundings(const ShapePointer& shape, double edge) {
    rigids.push_back({"body", shape, {}});
    ShapeMeshOptions options;
    options.dimensions = 2;
    options.axisymmetric = true;
    options.sizes.near = options.sizes.far = edge;
    SimplexMesh mesh = mesh_shape(shape, options).mesh;
    check_mesh(mesh);
    heat.push_back(meshed(std::move(mesh), steel(), {}));
    heat.back().interface_conductance = 1e4;
  }
  std::vector<InterfacePoint> points(Rings& rings, bool hybrid = false) {
    Domain domain;
    domain.dim = 2;
    InterfaceSearch search({{0, {true}, hybrid, -1}}, rigids, heat, domain, rings.particles.layout(), CubicSpline{}, dx,
                           1.3 * dx);
    search.check_fit(rings.particles, rigids, heat);
    return search.take_points(rings.particles, rigids, heat, 1);
  }
};

ShapePointer tube(double inner, double outer, double low, double high) {
  return std::make_shared<RevolvedProfile>(
      Vec3{0, 0, low}, Vec3{0, 0, 1},
      std::vector<RevolvedProfile::Vertex>{{inner, 0}, {outer, 0}, {outer, high - low}, {inner, high - low}}, "tube");
}

TEST(RingAreas, ContactWithAPlateAndABore) {
  for (const bool images : {false, true})
    for (const double edge : {1.3 * dx, 0.3 * dx}) {  // also with footprints shared out over several facets
      Rings rings(0, 10, 8, images);
      const double radius = 10 * dx, height = 8 * dx;
      Surroundings plate(tube(0, 1.5 * radius, -4 * dx, 0), edge),
          bore(tube(radius, 1.5 * radius, -dx, height + dx), edge);
      double on_plate = 0, in_bore = 0;
      for (const InterfacePoint& point : plate.points(rings)) on_plate += point.area;
      for (const InterfacePoint& point : bore.points(rings)) in_bore += point.area;
      EXPECT_NEAR(on_plate / (pi * radius * radius), 1, 2e-4);  // how the last rings share is not linear in the radius
      EXPECT_NEAR(in_bore / (2 * pi * radius * height), 1, 1e-12);
    }
}

/// A punch whose face is a cone, so that feet lie on slanted rings: the area is that of the cone.
TEST(RingAreas, ContactWithACone) {
  for (const bool images : {false, true}) {
    Rings rings(0, 16, 12, images);
    const double slope = std::tan(pi / 6);
    std::vector<SurfaceFoot> feet;
    const Vec3 normal = normalised(Vec3{slope, 0, 1});
    const ParticleSet& p = rings.particles;
    for (std::size_t i = 0; i < p.owned(); ++i) {
      const Vec3 x = p.vector_at(field::position, i);
      // Rings above the cone z = 3 dx - slope r ... with the lattice's staircase.
      const double distance = dot(x - Vec3{0, 0, 9 * dx}, normal);
      if (distance > 0.25 * dx && distance < contact_reach * dx)
        feet.push_back({static_cast<std::int32_t>(i), x - distance * normal, normal, distance});
    }
    const double got = sum(contact_areas(feet, feet.size(), dx, p.layout()));
    double last = 0;
    for (const SurfaceFoot& foot : feet) last = std::max(last, foot.point.x);
    const double reach = last + 0.5 * dx * std::cos(pi / 6), exact = pi * reach * reach / std::cos(pi / 6);
    std::printf("contact area on a cone: %+.2f %%\n", 100 * (got / exact - 1));
    EXPECT_NEAR(got / exact, 1, 0.03);
  }
}

/// The embedded particles fill the lattice also across the axis, and every path is that of a ring: the flow into a
/// plate whose nodes are hotter by a gradient along z is k times the gradient times the area.
TEST(RingHybrid, FlowIntoAPlate) {
  Rings rings(0, 10, 8, true);
  const double radius = 10 * dx;
  Surroundings plate(tube(0, 2 * radius, -6 * dx, 0), dx);
  const auto points = plate.points(rings, true);
  const double factor = lattice_conduction_factor(CubicSpline{}, 2, 1.3);
  double flow = 0, kernel_sum = 0;
  for (const InterfacePoint& point : points) {
    const Vec3 x = rings.particles.vector_at(field::position, static_cast<std::size_t>(point.particle));
    double there = 0;
    for (const NodeWeight& node : point.nodes) there += node.weight * plate.heat[0].mesh->mesh().nodes[node.node].z;
    if (x.x < radius - 3 * dx) flow += point.shape_factor / factor * (x.z - there);
    if (x.x < dx && x.z < dx) kernel_sum = point.kernel_sum;
  }
  // Seen from the particles, whose outermost three columns are left out here.
  EXPECT_NEAR(flow / (pi * std::pow(radius - 3 * dx, 2)), 1, 0.01);
  Rings whole(0, 10, 20, false);
  whole.graph();
  const Kernel kernel = CubicSpline{};
  double below = 0;  // sum over a half-space of lattice rows below the surface, dx/2 away
  for (int row = 1; row <= 3; ++row)
    for (int column = -4; column <= 4; ++column)
      below += dx * dx * kernel_value<CubicSpline>(std::hypot(row, column) * dx, 1.3 * dx, 2);
  EXPECT_NEAR(kernel_sum, below, 1e-12);
}

TEST(SectionMesh, VolumesAndAreasAreThoseOfTheBody) {
  const double inner = 3 * mm, outer = 8 * mm, height = 5 * mm;
  Surroundings ring(tube(inner, outer, 0, height), 0.8 * mm), disc(tube(0, outer, 0, height), 0.8 * mm);
  const HeatMesh& mesh = *ring.heat[0].mesh;
  double mass = 0, volume = 0;
  for (std::size_t n = 0; n < mesh.nodes(); ++n) {
    mass += mesh.node_mass(n);
    volume += mesh.node_volume(n);
  }
  const double exact = pi * (outer * outer - inner * inner) * height;
  EXPECT_NEAR(mass, steel_density * exact, 1e-12 * mass);
  EXPECT_NEAR(total_volume(mesh.mesh()), exact, 1e-12 * exact);
  EXPECT_NEAR(volume, exact, 1e-12 * exact);
  const double bore = sum(mesh.lumped_area(facets_at(mesh.mesh(), 0, inner)));
  EXPECT_NEAR(bore, 2 * pi * inner * height, 1e-12 * bore);
  const double bottom = sum(mesh.lumped_area(facets_at(mesh.mesh(), 2, 0)));
  EXPECT_NEAR(bottom, pi * (outer * outer - inner * inner), 1e-12 * bottom);
  EXPECT_NEAR(surface_area(mesh.mesh()), 2 * pi * (outer + inner) * height + 2 * bottom, 1e-12);

  // The axis is no surface, and nothing is nearest to it.
  const SimplexMesh& solid = disc.heat[0].mesh->mesh();
  EXPECT_NEAR(surface_area(solid), 2 * pi * outer * (outer + height), 1e-12);
  EXPECT_TRUE(facets_at(solid, 0, 0).empty());
  EXPECT_NEAR(disc.heat[0].mesh->nearest({1e-5, 0, 0.4 * height}).distance, 0.4 * height, 1e-9);
  for (std::size_t f = 0; f < solid.surface.size(); ++f) {
    const Vec3 middle = facet_centroid(solid, static_cast<std::int32_t>(f));
    const Vec3 outward = disc.rigids[0].nearest(middle).normal;
    EXPECT_GT(dot(normalised(facet_area_vector(solid, static_cast<std::int32_t>(f))), outward), 0.99);
  }
  // Any point on a circle stands for the place of the half-plane.
  const SurfacePlace folded = mesh.nearest({-3 * mm * std::cos(1.0), -3 * mm * std::sin(1.0), mm});
  EXPECT_LT(norm(folded.point - Vec3{3 * mm, 0, mm}), 1e-12);
  EXPECT_GE(ElementSearch(solid).find({0, -2 * mm, mm}).element, 0);
  EXPECT_EQ(ElementSearch(mesh.mesh()).find({0, -2 * mm, mm}).element, -1);
}

TEST(SectionMesh, SpheresConesAndCombinations) {
  const auto check = [](const ShapePointer& shape, double edge, double volume, double tolerance) {
    ShapeMeshOptions options;
    options.dimensions = 2;
    options.axisymmetric = true;
    options.sizes.near = options.sizes.far = edge;
    if (!std::isfinite(shape->bounds().low.x))
      options.cut = Bounds{{-6 * mm, -6 * mm, -3 * mm}, {6 * mm, 6 * mm, 9 * mm}};
    const ShapeMesh result = mesh_shape(shape, options);
    check_mesh(result.mesh);
    EXPECT_NEAR(total_volume(result.mesh) / volume, 1, tolerance) << shape->describe();
    EXPECT_LT(result.surface_gap, edge * edge / (8 * 4 * mm) * 1.2 + 1e-9) << shape->describe();
    for (const Vec3& node : result.mesh.nodes) {
      EXPECT_GE(node.x, 0);
      EXPECT_EQ(node.y, 0);
    }
  };
  const Vec3 up{0, 0, 1};
  check(std::make_shared<Sphere>(Vec3{0, 0, mm}, 4 * mm), 0.5 * mm, 4.0 / 3 * pi * std::pow(4 * mm, 3), 0.01);
  check(std::make_shared<RevolvedProfile>(
            Vec3{}, up, std::vector<RevolvedProfile::Vertex>{{0, 0}, {4 * mm, 0}, {0, 6 * mm}}, "turned"),
        0.5 * mm, pi / 3 * std::pow(4 * mm, 2) * 6 * mm, 1e-9);
  check(std::make_shared<RevolvedProfile>(
            Vec3{}, -up, std::vector<RevolvedProfile::Vertex>{{0, 0}, {4 * mm, 0}, {4 * mm, 6 * mm}, {0, 6 * mm}},
            "turned"),
        0.5 * mm, pi * std::pow(4 * mm, 2) * 6 * mm, 1e-9);
  check(std::make_shared<HalfSpace>(Vec3{0, 0, 0}, up), 0.8 * mm, pi * std::pow(6 * mm, 2) * 3 * mm, 1e-9);
  check(std::make_shared<Torus>(Vec3{0, 0, mm}, up, 5 * mm, 4 * mm), 0.5 * mm,
        2 * pi * pi * 5 * mm * std::pow(4 * mm, 2), 0.01);
  // A cup and two separate rings.
  const ShapePointer pot = std::make_shared<Difference>(tube(0, 6 * mm, 0, 8 * mm),
                                                        std::vector<ShapePointer>{tube(0, 4 * mm, 3 * mm, 9 * mm)});
  check(pot, 0.7 * mm, pi * (36 * 8 - 16 * 5) * mm * mm * mm, 1e-9);
  const auto pair =
      std::make_shared<Union>(std::vector<ShapePointer>{tube(2 * mm, 4 * mm, 0, mm), tube(0, 4 * mm, 5 * mm, 7 * mm)});
  check(pair, 0.5 * mm, pi * (12 * 1 + 16 * 2) * mm * mm * mm, 1e-9);
}

TEST(SectionMesh, FilesLieInTheHalfPlane) {
  const Surroundings disc(tube(0, 6 * mm, 0, 4 * mm), mm);
  const std::string path = std::string(STIRSPH_BINARY_DIR) + "/section_" + std::to_string(Comm().rank()) + ".msh";
  SimplexMesh mesh = disc.heat[0].mesh->mesh();
  write_mesh_file(mesh, path, MeshFileFormat::Text2);
  const SimplexMesh read = read_mesh_file(path, {2, 1, "", true});
  check_mesh(read);
  EXPECT_NEAR(surface_area(read), surface_area(mesh), 1e-9 * surface_area(mesh));
  EXPECT_NEAR(total_volume(read), total_volume(mesh), 1e-9 * total_volume(mesh));

  for (Vec3& node : mesh.nodes) node = {node.x, node.z, 0};  // drawn as r, z in the plane of x and y
  mesh.axisymmetric = false;
  write_mesh_file(mesh, path, MeshFileFormat::Text2);
  try {
    read_mesh_file(path, {2, 1, "", true});
    FAIL() << "a section in another plane was taken";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("half-plane y = 0, x >= 0"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace stirsph::testing
