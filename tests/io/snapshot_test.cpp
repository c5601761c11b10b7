// Snapshots have the structure of VTKHDF 1.0 and the values of the particles, from any number of ranks.
#include "io/snapshot.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>

#include "io/hdf5_file.hpp"
#include "io_fixture.hpp"

namespace stirsph::test {
namespace {

namespace fs = std::filesystem;

std::string contents(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// 10 particles on every rank but the last of several, which has none.
ParticleSet particles_on(const Comm& comm, SpaceLayout layout) {
  ParticleSet particles(layout);
  add_fields(particles);
  fill(particles, comm.size() > 1 && comm.rank() == comm.size() - 1 ? 0 : 10, 10.0 * comm.rank());
  return particles;
}

TEST(Snapshot, HasTheStructureOfVtkHdf) {
  const Comm world;
  const ScratchFolder folder;
  const ParticleSet particles = particles_on(world, layout_of<Cartesian3>());
  const std::int64_t total = world.sum(std::int64_t(particles.owned()));
  SnapshotSeries series(world, folder.path());
  const DerivedField derived{"von_mises", "Pa", "von Mises stress", std::vector<double>(particles.owned(), 2.5e8)};
  const std::string path = series.write(particles, 0.25, 17, {derived});
  EXPECT_EQ(path, folder / "snapshot_000000.vtkhdf");
  EXPECT_FALSE(fs::exists(path + ".part"));

  Hdf5File file(world, path, Hdf5File::Mode::Read);
  EXPECT_EQ(file.text_attribute("VTKHDF", "Type"), "UnstructuredGrid");
  EXPECT_TRUE(file.has_attribute("VTKHDF", "Version"));
  EXPECT_EQ(file.number_attribute("VTKHDF", "time"), 0.25);
  EXPECT_EQ(file.whole_attribute("VTKHDF", "step"), 17);
  for (const char* name : {"NumberOfPoints", "NumberOfCells", "NumberOfConnectivityIds"})
    EXPECT_EQ(file.read_replicated<std::int64_t>(std::string("VTKHDF/") + name), std::vector<std::int64_t>{total});
  const auto connectivity = file.read_replicated<std::int64_t>("VTKHDF/Connectivity");
  const auto offsets = file.read_replicated<std::int64_t>("VTKHDF/Offsets");
  ASSERT_EQ(std::ssize(connectivity), total);
  ASSERT_EQ(std::ssize(offsets), total + 1);
  for (std::int64_t k = 0; k < total; ++k) ASSERT_TRUE(connectivity[k] == k && offsets[k] == k);
  EXPECT_EQ(offsets.back(), total);
  EXPECT_EQ(file.read_replicated<std::uint8_t>("VTKHDF/Types"), std::vector<std::uint8_t>(total, 1));

  EXPECT_EQ(file.columns("VTKHDF/Points"), 3);
  const auto points = file.read_replicated<float>("VTKHDF/Points");
  const auto ids = file.read_replicated<std::int64_t>("VTKHDF/PointData/id");
  const auto stress = file.read_replicated<float>("VTKHDF/PointData/stress");
  EXPECT_EQ(file.columns("VTKHDF/PointData/stress"), 6);
  const int vtk_order[6] = {0, 1, 2, 3, 5, 4};  // ours: xx yy zz xy xz yz
  for (std::int64_t k = 0; k < total; ++k) {
    const auto id = static_cast<double>(ids[k]);
    for (int c = 0; c < 3; ++c) ASSERT_EQ(points[3 * k + c], static_cast<float>(value_of(id, c, 1)));
    for (int c = 0; c < 6; ++c) ASSERT_EQ(stress[6 * k + c], static_cast<float>(value_of(id, vtk_order[c], 4)));
  }
  EXPECT_EQ(file.text_attribute("VTKHDF/PointData/temperature", "unit"), "K");
  EXPECT_EQ(file.text_attribute("VTKHDF/PointData/von_mises", "meaning"), "von Mises stress");
  EXPECT_EQ(file.read_replicated<float>("VTKHDF/PointData/von_mises"), std::vector<float>(total, 2.5e8F));
  EXPECT_FALSE(file.has("VTKHDF/PointData/stress_deviator"));  // not among those written by default
}

/// A ring stands at (r, 0, z), wherever it is and wherever it began; one further field is written when asked for.
TEST(Snapshot, AxisymmetricPositionsLieInTheHalfPlane) {
  const Comm world;
  const ScratchFolder folder;
  ParticleSet particles(layout_of<AxisymmetricSwirl>());
  add_fields(particles);
  particles.add(field::initial_position);
  fill(particles, 5, 5.0 * world.rank());
  for (std::size_t i = 0; i < 5; ++i) {
    particles.component(field::initial_position, 0)[i] = 2;
    particles.component(field::initial_position, 1)[i] = 7;
  }
  SnapshotSeries usual(world, folder.path());
  EXPECT_FALSE(
      Hdf5File(world, usual.write(particles, 0, 0), Hdf5File::Mode::Read).has("VTKHDF/PointData/initial_position"));
  SnapshotSeries series(world, folder.path(), {}, field::initial_position.name);
  Hdf5File file(world, series.write(particles, 0, 0), Hdf5File::Mode::Read);
  EXPECT_TRUE(file.has("VTKHDF/PointData/temperature")) << "besides the usual ones";
  const auto points = file.read_replicated<float>("VTKHDF/Points"),
             start = file.read_replicated<float>("VTKHDF/PointData/initial_position");
  ASSERT_EQ(start.size(), points.size());
  for (std::size_t k = 0; k < start.size(); k += 3) {
    EXPECT_EQ(points[k + 1], 0);
    EXPECT_NE(points[k + 2], 0);
    EXPECT_TRUE(start[k] == 2 && start[k + 1] == 0 && start[k + 2] == 7);
  }
}

TEST(Snapshot, PlaneStrainIsWrittenAsThreeDimensions) {
  const Comm world;
  const ScratchFolder folder;
  SnapshotSeries series(world, folder.path(), {"stress"});
  const std::string path = series.write(particles_on(world, layout_of<PlaneStrain>()), 0, 0);
  Hdf5File file(world, path, Hdf5File::Mode::Read);
  EXPECT_EQ(file.members("VTKHDF/PointData"), std::vector<std::string>{"stress"});
  const auto points = file.read_replicated<float>("VTKHDF/Points");
  const auto stress = file.read_replicated<float>("VTKHDF/PointData/stress");
  for (std::size_t k = 0; k < points.size() / 3; ++k) {
    ASSERT_EQ(points[3 * k + 2], 0.0F);
    ASSERT_NE(stress[6 * k + 3], 0.0F);
    ASSERT_TRUE(stress[6 * k + 4] == 0.0F && stress[6 * k + 5] == 0.0F);
  }
}

TEST(Snapshot, TheIndexFollowsTheRunAndItsRestart) {
  const Comm world;
  const ScratchFolder folder;
  const ParticleSet particles = particles_on(world, layout_of<Cartesian3>());
  {
    SnapshotSeries series(world, folder.path(), {"temperature"});
    for (int k = 0; k < 4; ++k) series.write(particles, 0.1 * k, 10 * k);
  }
  SnapshotSeries series(world, folder.path(), {"temperature"});
  series.resume(0.1, 1e-6);
  EXPECT_EQ(series.next(), 2);
  series.write(particles, 0.15, 15);
  world.barrier();
  EXPECT_EQ(contents(folder / "snapshots.csv"),
            "number,step,time [s],file,rigid file\n0,0,0,snapshot_000000.vtkhdf,\n1,10,0.1,snapshot_000001.vtkhdf,\n"
            "2,15,0.15,snapshot_000002.vtkhdf,\n");
  const std::string json = contents(folder / "snapshots.vtkhdf.series");
  EXPECT_NE(json.find("{\"name\": \"snapshot_000002.vtkhdf\", \"time\": 0.15}"), std::string::npos) << json;
}

TEST(Snapshot, AnUnknownFieldIsAnInputError) {
  const Comm world;
  const ScratchFolder folder;
  SnapshotSeries series(world, folder.path(), {"temprature"});
  try {
    series.write(particles_on(world, layout_of<Cartesian3>()), 0, 0);
    ADD_FAILURE();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::Input);
  }
}

}  // namespace
}  // namespace stirsph::test
