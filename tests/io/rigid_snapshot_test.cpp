// Meshed rigid bodies lie beside the snapshot of the particles: one VTKHDF grid of all bodies, where they are, under
// the same number, before and after a restart.
#include "io/rigid_snapshot.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <numbers>

#include "io/hdf5_file.hpp"
#include "io/snapshot.hpp"
#include "io_fixture.hpp"

namespace stirsph::test {
namespace {

namespace fs = std::filesystem;

std::string contents(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// Two tetrahedra on one face.
SimplexMesh two_tetrahedra() {
  SimplexMesh mesh;
  mesh.nodes = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 1}};
  mesh.elements = {{0, 1, 2, 3}, {1, 4, 2, 3}};
  return mesh;
}

SimplexMesh one_tetrahedron() {
  SimplexMesh mesh;
  mesh.nodes = {{2, 0, 0}, {3, 0, 0}, {2, 1, 0}, {2, 0, 1}};
  mesh.elements = {{0, 1, 2, 3}};
  return mesh;
}

SimplexMesh two_triangles() {
  SimplexMesh mesh;
  mesh.dim = 2;
  mesh.nodes = {{0, 0, 0}, {2, 0, 0}, {2, 1, 0}, {0, 1, 0}};
  mesh.elements = {{0, 1, 2, -1}, {0, 2, 3, -1}};
  return mesh;
}

/// Known to the root only: the other ranks need not hold it.
MeshState state_of(const SimplexMesh& mesh, std::int64_t body, const RigidPose& pose, double first_temperature) {
  if (!Comm().is_root()) return {};
  MeshState state{&mesh, body, nodes_in_scene(mesh, pose), {}};
  for (std::size_t n = 0; n < mesh.nodes.size(); ++n)
    state.temperature.push_back(first_temperature + static_cast<double>(n));
  return state;
}

ParticleSet some_particles() {
  ParticleSet particles(layout_of<Cartesian3>());
  add_fields(particles);
  fill(particles, 3, 3.0 * Comm().rank());
  return particles;
}

TEST(RigidSnapshot, NodesAreCarriedByThePose) {
  SimplexMesh mesh;
  mesh.nodes = {{2, 0, 0}, {1, 3, 5}};
  RigidPose pose;
  pose.centre = {1, 0, 0};
  pose.axis = {0, 0, 1};
  pose.angle = std::numbers::pi / 2;
  pose.translation = {0.5, 0, 2};
  const std::vector<Vec3> points = nodes_in_scene(mesh, pose);
  // A quarter turn about the axis through (1, 0): (1, 0) beside it becomes (0, 1), (0, 3) becomes (-3, 0).
  const Vec3 expected[] = {{1.5, 1, 2}, {-1.5, 0, 7}};
  ASSERT_EQ(points.size(), 2U);
  for (int n = 0; n < 2; ++n)
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(points[n][c], expected[n][c], 1e-14);  // a few roundings of numbers near 1
}

TEST(RigidSnapshot, HoldsAllBodiesInOneGrid) {
  const Comm world;
  const ScratchFolder folder;
  const SimplexMesh die = two_tetrahedra(), tool = one_tetrahedron();
  RigidPose lifted;
  lifted.translation = {0, 0, 0.5};
  SnapshotSeries series(world, folder.path());
  series.write(some_particles(), 0.25, 17, {}, {state_of(die, 0, {}, 300), state_of(tool, 3, lifted, 400)});
  const std::string path = rigid_snapshot_path(folder.path(), 0);
  EXPECT_EQ(path, folder / "rigid_000000.vtkhdf");
  EXPECT_FALSE(fs::exists(path + ".part"));

  Hdf5File file(world, path, Hdf5File::Mode::Read);
  EXPECT_EQ(file.text_attribute("VTKHDF", "Type"), "UnstructuredGrid");
  EXPECT_TRUE(file.has_attribute("VTKHDF", "Version"));
  EXPECT_EQ(file.number_attribute("VTKHDF", "time"), 0.25);
  EXPECT_EQ(file.whole_attribute("VTKHDF", "step"), 17);
  using Whole = std::vector<std::int64_t>;
  EXPECT_EQ(file.read_replicated<std::int64_t>("VTKHDF/NumberOfPoints"), Whole{9});
  EXPECT_EQ(file.read_replicated<std::int64_t>("VTKHDF/NumberOfCells"), Whole{3});
  EXPECT_EQ(file.read_replicated<std::int64_t>("VTKHDF/NumberOfConnectivityIds"), Whole{12});
  // The nodes of the second body follow the five of the first.
  EXPECT_EQ(file.read_replicated<std::int64_t>("VTKHDF/Connectivity"), (Whole{0, 1, 2, 3, 1, 4, 2, 3, 5, 6, 7, 8}));
  EXPECT_EQ(file.read_replicated<std::int64_t>("VTKHDF/Offsets"), (Whole{0, 4, 8, 12}));
  EXPECT_EQ(file.read_replicated<std::uint8_t>("VTKHDF/Types"), (std::vector<std::uint8_t>{10, 10, 10}));
  EXPECT_EQ(file.read_replicated<std::int64_t>("VTKHDF/CellData/body"), (Whole{0, 0, 3}));
  EXPECT_EQ(file.read_replicated<float>("VTKHDF/PointData/temperature"),
            (std::vector<float>{300, 301, 302, 303, 304, 400, 401, 402, 403}));
  EXPECT_EQ(file.columns("VTKHDF/Points"), 3);
  EXPECT_EQ(
      file.read_replicated<float>("VTKHDF/Points"),
      (std::vector<float>{0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 1, 1, 1, 2, 0, 0.5, 3, 0, 0.5, 2, 1, 0.5, 2, 0, 1.5}));

  EXPECT_EQ(file.text_attribute("VTKHDF/Points", "unit"), "m");
  EXPECT_EQ(file.text_attribute("VTKHDF/PointData/temperature", "unit"), "K");
  EXPECT_EQ(file.text_attribute("VTKHDF/PointData/temperature", "meaning"), "temperature of the node");
  EXPECT_EQ(file.text_attribute("VTKHDF/CellData/body", "unit"), "1");
  EXPECT_NE(file.text_attribute("VTKHDF/CellData/body", "meaning").find("rigid bodies"), std::string::npos);
}

TEST(RigidSnapshot, APlaneMeshIsTriangles) {
  const Comm world;
  const ScratchFolder folder;
  const SimplexMesh plate = two_triangles();
  const std::string path = rigid_snapshot_path(folder.path(), 7);
  write_rigid_snapshot(world, path, {state_of(plate, 1, {}, 300)}, 0, 0);
  Hdf5File file(world, path, Hdf5File::Mode::Read);
  using Whole = std::vector<std::int64_t>;
  EXPECT_EQ(file.read_replicated<std::int64_t>("VTKHDF/NumberOfConnectivityIds"), Whole{6});
  EXPECT_EQ(file.read_replicated<std::int64_t>("VTKHDF/Connectivity"), (Whole{0, 1, 2, 0, 2, 3}));
  EXPECT_EQ(file.read_replicated<std::int64_t>("VTKHDF/Offsets"), (Whole{0, 3, 6}));
  EXPECT_EQ(file.read_replicated<std::uint8_t>("VTKHDF/Types"), (std::vector<std::uint8_t>{5, 5}));
  EXPECT_EQ(file.read_replicated<float>("VTKHDF/Points"), (std::vector<float>{0, 0, 0, 2, 0, 0, 2, 1, 0, 0, 1, 0}));
}

TEST(RigidSnapshot, NumbersAndIndexFollowTheParticlesThroughARestart) {
  const Comm world;
  const ScratchFolder folder;
  const ParticleSet particles = some_particles();
  const SimplexMesh die = two_tetrahedra();
  const auto write = [&](SnapshotSeries& series, double time, std::int64_t step, double temperature) {
    series.write(particles, time, step, {}, {state_of(die, 0, {}, temperature)});
  };
  {
    SnapshotSeries series(world, folder.path(), {"temperature"});
    for (int k = 0; k < 4; ++k) write(series, 0.1 * k, 10 * k, 300 + 10 * k);
  }
  SnapshotSeries series(world, folder.path(), {"temperature"});
  series.resume(0.1, 1e-6);
  EXPECT_EQ(series.next(), 2);
  world.barrier();
  const std::string head =
      "{\n  \"file-series-version\": \"1.0\",\n  \"files\": [\n"
      "    {\"name\": \"rigid_000000.vtkhdf\", \"time\": 0},\n"
      "    {\"name\": \"rigid_000001.vtkhdf\", \"time\": 0.1}";
  EXPECT_EQ(contents(folder / "rigid.vtkhdf.series"), head + "\n  ]\n}\n");  // the later ones are forgotten
  world.barrier();
  write(series, 0.15, 15, 500);
  world.barrier();
  EXPECT_EQ(contents(folder / "rigid.vtkhdf.series"),
            head + ",\n    {\"name\": \"rigid_000002.vtkhdf\", \"time\": 0.15}\n  ]\n}\n");
  EXPECT_EQ(contents(folder / "snapshots.csv"),
            "number,step,time [s],file,rigid file\n0,0,0,snapshot_000000.vtkhdf,rigid_000000.vtkhdf\n"
            "1,10,0.1,snapshot_000001.vtkhdf,rigid_000001.vtkhdf\n"
            "2,15,0.15,snapshot_000002.vtkhdf,rigid_000002.vtkhdf\n");
  Hdf5File file(world, folder / "rigid_000002.vtkhdf", Hdf5File::Mode::Read);
  EXPECT_EQ(file.number_attribute("VTKHDF", "time"), 0.15);
  EXPECT_EQ(file.read_replicated<float>("VTKHDF/PointData/temperature")[0], 500.0F);
}

TEST(RigidSnapshot, ASceneWithoutMeshesHasNone) {
  const Comm world;
  const ScratchFolder folder;
  const SimplexMesh die = two_tetrahedra();
  const ParticleSet particles = some_particles();
  SnapshotSeries earlier(world, folder.path());
  earlier.write(particles, 0, 0, {}, {state_of(die, 0, {}, 300)});
  world.barrier();
  if (world.is_root()) fs::remove(folder / "rigid_000000.vtkhdf");
  SnapshotSeries series(world, folder.path());
  series.write(particles, 0, 0);
  world.barrier();
  EXPECT_FALSE(fs::exists(folder / "rigid_000000.vtkhdf"));
  EXPECT_FALSE(fs::exists(folder / "rigid.vtkhdf.series"));  // the earlier run's would show its bodies with this run
  EXPECT_EQ(contents(folder / "snapshots.csv"),
            "number,step,time [s],file,rigid file\n0,0,0,snapshot_000000.vtkhdf,\n");
  SnapshotSeries continued(world, folder.path());
  continued.resume(0, 1e-6);
  world.barrier();
  EXPECT_FALSE(fs::exists(folder / "rigid.vtkhdf.series"));
}

TEST(RigidSnapshot, AFileThatCannotBeWrittenStopsAllRanks) {
  const Comm world;
  const ScratchFolder folder;
  const SimplexMesh die = two_tetrahedra();
  const std::string path = rigid_snapshot_path(folder.path(), 0);
  if (world.is_root()) fs::create_directories(path + "/in_the_way");
  world.barrier();
  SnapshotSeries series(world, folder.path());
  const std::string message =
      message_of_io_error([&] { series.write(some_particles(), 0, 0, {}, {state_of(die, 0, {}, 300)}); });
  EXPECT_NE(message.find(path), std::string::npos) << message;
  world.barrier();
  EXPECT_FALSE(fs::exists(path + ".part"));
  EXPECT_EQ(series.next(), 0);
  EXPECT_FALSE(fs::exists(folder / "snapshots.csv"));
}

}  // namespace
}  // namespace stirsph::test
