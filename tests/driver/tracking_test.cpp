/// Where the material goes: mixing index, spread, path tracers, snapshots at chosen times, initial positions.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <sstream>

#include "driver/mixing.hpp"
#include "driver/probes.hpp"
#include "driver/run.hpp"
#include "io/hdf5_file.hpp"
#include "io/snapshot.hpp"
#include "support/scene_run.hpp"

namespace stirsph::testing {
namespace {

const std::string inputs = std::string(STIRSPH_SOURCE_DIR) + "/inputs";

std::string scratch(const Comm& comm, const std::string& name) {
  const std::string folder = std::string(STIRSPH_BINARY_DIR) + "/tracking_test_" + std::to_string(comm.size());
  if (comm.is_root()) {
    std::filesystem::create_directories(folder);
    std::filesystem::remove_all(folder + "/" + name);
  }
  comm.barrier();
  return folder + "/" + name;
}

std::string content(const std::string& path) {
  std::ifstream file(path);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

/// A block of two bodies whose particles the tests deal out anew.
std::string block(const std::string& more = "") {
  return R"toml(
[numerics]
spacing = "1 mm"
[time]
end = "1 ms"
[[material]]
name = "A"
file = "materials/aa2024_t351.toml"
[[material]]
name = "B"
file = "materials/aa6082_t6.toml"
[[body]]
name = "left"
material = "A"
shape = { type = "box", low = ["-12 mm", "-6 mm", "0 mm"], high = ["0 mm", "6 mm", "12 mm"] }
[[body]]
name = "right"
material = "B"
shape = { type = "box", low = ["0 mm", "-6 mm", "0 mm"], high = ["12 mm", "6 mm", "12 mm"] }
)toml" + more;
}

/// The index after the bodies were given to the particles anew: `to` tells from place and id.
double index_of(Simulation& simulation, const std::function<int(const Vec3&, std::int64_t)>& to) {
  ParticleSet& particles = simulation.particles();
  for (std::size_t i = 0; i < particles.owned(); ++i)
    particles[field::body][i] =
        to(particles.vector_at(field::position, i), static_cast<std::int64_t>(particles[field::id][i]));
  simulation.neighbourhood().halo().exchange(particles, Halo::Static);
  return mixing_index(simulation, -1, true);
}

/// A number in [0, 1) that depends on the id only.
double dice(std::int64_t id) {
  const double x = std::sin(12.9898 * static_cast<double>(id)) * 43758.5453;
  return x - std::floor(x);
}

TEST(Mixing, SeparatedIsNearZeroRandomIsOneAndBetweenItRises) {
  Simulation simulation(Comm(), read_scene_text(block(), inputs));
  simulation.start();
  const auto half = [](const Vec3& x, std::int64_t) { return x.x > 0 ? 1 : 0; };
  const double halves = index_of(simulation, half);
  std::printf("two halves: %.4f\n", halves);
  EXPECT_GT(halves, 0);
  EXPECT_LT(halves, 0.08) << "only the smoothing over the interface counts: 2h of 24 spacings";

  // Layers ever finer: 12, 6, 3, 2, 1 spacings.
  double last = halves;
  for (const double layer : {6, 3, 2, 1}) {
    const double index = index_of(simulation, [&](const Vec3& x, std::int64_t) {
      return static_cast<int>(std::floor(1e3 * x.x / layer + 1e-6) + 100) % 2;
    });
    std::printf("layers of %g spacings: %.4f\n", layer, index);
    EXPECT_GT(index, last);
    last = index;
  }

  // A growing share of the particles dealt out at random.
  last = halves;
  for (const double share : {0.25, 0.5, 0.75, 1.0}) {
    const double index = index_of(simulation, [&](const Vec3& x, std::int64_t id) {
      return dice(id) < share ? (dice(id + 1000000) < 0.5 ? 1 : 0) : half(x, id);
    });
    std::printf("%3.0f %% at random: %.4f\n", 100 * share, index);
    EXPECT_GT(index, last);
    last = index;
  }
  EXPECT_NEAR(last, 1, 0.02);  // 3456 particles: the variance itself scatters by some per cent of its random value

  // Unequal shares: also about 1.
  const double few = index_of(simulation, [&](const Vec3&, std::int64_t id) { return dice(id) < 0.1 ? 1 : 0; });
  std::printf("a tenth at random: %.4f\n", few);
  EXPECT_NEAR(few, 1, 0.02);
  EXPECT_TRUE(std::isnan(index_of(simulation, [](const Vec3&, std::int64_t) { return 0; })));
}

TEST(Mixing, ProbesOfSpreadAndMixing) {
  Simulation simulation(Comm(), read_scene_text(block(R"toml(
[[set]]
name = "left"
bodies = ["left"]
[[probe]]
name = "mixing"
kind = "mixing"
[[probe]]
name = "angles"
kind = "angular_spread"
[[probe]]
name = "angles_left"
kind = "angular_spread"
set = "left"
[[probe]]
name = "radius"
kind = "average"
field = "radius"
[[probe]]
name = "height"
kind = "deviation"
field = "height"
set = "left"
)toml"),
                                                inputs));
  check_field_names(simulation);
  simulation.start();
  const std::vector<double> values = evaluate_probes(simulation);
  EXPECT_NEAR(values[0], mixing_index(simulation, -1, true), 1e-15);
  EXPECT_NEAR(values[1], 1, 1e-12) << "symmetric about the axis";
  double cosines = 0, radii = 0;
  for (int a = 0; a < 12; ++a)
    for (int b = -6; b < 6; ++b) {
      cosines += (a + 0.5) / std::hypot(a + 0.5, b + 0.5) / 144;
      radii += std::hypot(a + 0.5, b + 0.5) / 144;
    }
  EXPECT_NEAR(values[2], 1 - cosines, 1e-12);
  EXPECT_NEAR(values[3], 1e-3 * radii, 1e-15);
  EXPECT_NEAR(values[4], 1e-3 * std::sqrt((12 * 12 - 1) / 12.0), 1e-12);
  EXPECT_EQ(probe_unit(simulation.scene(), simulation.scene().probes[0]), "1");
  EXPECT_EQ(probe_unit(simulation.scene(), simulation.scene().probes[3]), "m");
}

ExitCode run(const Comm& comm, const std::string& folder, const std::vector<std::string>& overrides,
             const std::string& restart = "") {
  RunOptions options;
  options.folder = folder;
  options.quiet = true;
  options.restart = restart;
  return run_scene(comm, read_scene(verification_scene("tracked_tube"), overrides), options);
}

TEST(Tracers, AfterARestartNothingIsMissingOrTwice) {
  const Comm comm;
  const std::string straight = scratch(comm, "straight"), stopped = scratch(comm, "stopped");
  ASSERT_EQ(run(comm, straight, {}), ExitCode::Finished);
  // The run is lost at step 100; the newest checkpoint is that of step 80, and the records since come again.
  ASSERT_EQ(run(comm, stopped, {"output.checkpoint_steps=80", "time.most_steps=100"}), ExitCode::Finished);
  const std::string lost = content(stopped + "/tracer_sheet.csv");
  ASSERT_EQ(run(comm, stopped, {}, checkpoint_path(stopped, 80)), ExitCode::Finished);
  const std::string expected = content(straight + "/tracer_sheet.csv");
  EXPECT_GT(expected.size(), 1000u);
  EXPECT_LT(lost.size(), expected.size());
  EXPECT_TRUE(content(stopped + "/tracer_sheet.csv") == expected);

  std::istringstream rows(expected);
  std::string header, line;
  std::getline(rows, header);
  EXPECT_EQ(header,
            "time [s],id [1],x [m],y [m],z [m],temperature [K],equivalent_plastic_strain [1],grain_size [m],"
            "hardness [HV],body [1]");
  std::map<std::string, std::vector<double>> ids;
  std::vector<std::string> times;
  while (std::getline(rows, line)) {
    const std::string time = line.substr(0, line.find(','));
    if (ids[time].empty()) times.push_back(time);
    ids[time].push_back(std::stod(line.substr(line.find(',') + 1)));
  }
  EXPECT_EQ(times.size(), 21u) << "every ms of 20 ms and the start";
  for (const auto& [time, list] : ids) {
    EXPECT_EQ(list, ids.begin()->second) << time;
    EXPECT_TRUE(std::ranges::is_sorted(list)) << time;
  }
}

TEST(Tracers, RanksAgree) {
  const Comm world;
  if (world.size() < 2) GTEST_SKIP() << "needs two ranks";
  const std::string together = scratch(world, "together"), alone = scratch(world, "alone");
  ASSERT_EQ(run(world, together, {"time.most_steps=40"}), ExitCode::Finished);
  if (world.is_root()) {
    ASSERT_EQ(run(Comm(MPI_COMM_SELF), alone, {"time.most_steps=40"}), ExitCode::Finished);
    std::ifstream a(together + "/tracer_sheet.csv"), b(alone + "/tracer_sheet.csv");
    std::string left, right;
    int rows = 0;
    while (std::getline(a, left)) {
      ASSERT_TRUE(std::getline(b, right));
      if (rows++ == 0) continue;
      std::istringstream one(left), two(right);
      for (std::string x, y; std::getline(one, x, ',');) {
        ASSERT_TRUE(std::getline(two, y, ','));
        EXPECT_NEAR(std::stod(x), std::stod(y), 1e-8 * std::abs(std::stod(y)) + 1e-12) << left << "\n" << right;
      }
    }
    EXPECT_FALSE(std::getline(b, right));
    EXPECT_GT(rows, 50);
  }
  world.barrier();
}

TEST(Snapshots, AtChosenTimesWithInitialPositions) {
  const Comm comm;
  const std::string folder = scratch(comm, "times");
  ASSERT_EQ(run(comm, folder, {"output.snapshot_interval=10 ms"}), ExitCode::Finished);
  std::ifstream index(folder + "/snapshots.csv");
  std::vector<double> times;
  std::string line;
  std::getline(index, line);
  while (std::getline(index, line)) times.push_back(std::stod(line.substr(line.find(',', line.find(',') + 1) + 1)));
  // The start, 5, 7, 10 and 20 ms: 10 ms is asked for twice and comes once; 1 s never comes.
  ASSERT_EQ(times.size(), 5u);
  const double expected[] = {0, 5e-3, 7e-3, 10e-3, 20e-3};
  const double half_step = 0.8e-4;
  for (int k = 0; k < 5; ++k) EXPECT_NEAR(times[static_cast<std::size_t>(k)], expected[k], half_step);

  Hdf5File file(comm, snapshot_path(folder, 4), Hdf5File::Mode::Read);
  for (const char* name : {"initial_position", "body", "material", "grain_size", "hardness", "strain_rate_average"})
    EXPECT_TRUE(file.has("VTKHDF/PointData/" + std::string(name))) << name;
  EXPECT_TRUE(file.has("VTKHDF/PointData/recrystallised"));
  const auto start = file.read_replicated<float>("VTKHDF/PointData/initial_position");
  Hdf5File first(comm, snapshot_path(folder, 0), Hdf5File::Mode::Read);
  const auto ids = file.read_replicated<std::int64_t>("VTKHDF/PointData/id"),
             first_ids = first.read_replicated<std::int64_t>("VTKHDF/PointData/id");
  const auto points = first.read_replicated<float>("VTKHDF/Points");
  std::map<std::int64_t, std::size_t> place;
  for (std::size_t k = 0; k < first_ids.size(); ++k) place[first_ids[k]] = k;
  for (std::size_t k = 0; k < ids.size(); ++k)
    for (std::size_t c = 0; c < 3; ++c) EXPECT_EQ(start[3 * k + c], points[3 * place.at(ids[k]) + c]);
}

}  // namespace
}  // namespace stirsph::testing
