/// What `check --partition` counts on one rank is what a run on that many ranks has.
#include <gtest/gtest.h>

#include <numeric>

#include "driver/partition_check.hpp"
#include "support/scene_run.hpp"

namespace stirsph::testing {
namespace {

/// A bar with a notch: parts differ in shape and border.
const char* const bar = R"(
[numerics]
spacing = "1 mm"
artificial_stress = 0.3
[time]
end = "1 s"
step = "1e-8 s"
[[material]]
name = "AL"
file = "al.toml"
[[body]]
name = "bar"
material = "AL"
shape = { type = "box", low = ["0 mm", "0 mm", "0 mm"], high = ["30 mm", "12 mm", "12 mm"] }
[[body]]
name = "step"
material = "AL"
shape = { type = "box", low = ["0 mm", "0 mm", "12 mm"], high = ["17 mm", "7 mm", "18 mm"] }
)";

Scene scene_of(const std::string& text) {
  return read_scene_text(text, std::string(STIRSPH_SOURCE_DIR) + "/tests/verification/materials");
}

template <class Value>
std::int64_t total(const Partition& partition, Value&& value) {
  return std::accumulate(partition.shares.begin(), partition.shares.end(), std::int64_t(0),
                         [&](std::int64_t sum, const PartShare& share) { return sum + value(share); });
}

void expect_as_in_a_run(const Scene& scene) {
  const Comm comm;
  const Partition partition = study_partitions(scene, {comm.size()}).partitions.at(0);
  ASSERT_FALSE(partition.by_work) << "a run cuts by particles at the start: choose a more even scene";
  Simulation simulation(comm, scene);
  simulation.start();
  const PartShare& own = partition.shares.at(comm.rank());
  EXPECT_EQ(static_cast<std::size_t>(own.particles), simulation.particles().owned());
  EXPECT_EQ(static_cast<std::size_t>(own.candidates), simulation.neighbourhood().pairs().size());
  EXPECT_EQ(static_cast<std::size_t>(own.sent), simulation.neighbourhood().halo().sent());
  EXPECT_EQ(static_cast<std::size_t>(own.received), simulation.neighbourhood().halo().received());
  EXPECT_DOUBLE_EQ(partition.imbalance(), simulation.imbalance());
}

TEST(PartitionCheck, CountsAreThoseOfARun) { expect_as_in_a_run(scene_of(bar)); }

TEST(PartitionCheck, CountsAreThoseOfARunWithPeriodicImages) {
  const std::string domain =
      "[domain]\nperiodic = [\"x\"]\nlow = [\"0 mm\", \"0 mm\", \"0 mm\"]\nhigh = [\"30 mm\", \"12 mm\", \"18 mm\"]\n";
  const Scene scene = scene_of(bar + domain);
  expect_as_in_a_run(scene);
  EXPECT_GT(study_partitions(scene, {1}).partitions[0].shares[0].sent, 0) << "images of one's own particles";
}

TEST(PartitionCheck, PartsCoverAllParticlesAndCopiesArrive) {
  const PartitionStudy found = study_partitions(scene_of(bar), {1, 2, 7, 50, 5000});
  EXPECT_EQ(found.particles, 30 * 12 * 12 + 17 * 7 * 6);
  EXPECT_EQ(found.kinematic_bytes, 8 * (3 + 3));
  EXPECT_EQ(found.stress_bytes, 8 * (6 + 6 + 3)) << "stress, artificial stress; strain, volume, smoothing length";
  ASSERT_EQ(found.partitions.size(), 5u);
  for (const Partition& partition : found.partitions) {
    SCOPED_TRACE(partition.parts);
    ASSERT_EQ(partition.shares.size(), static_cast<std::size_t>(partition.parts));
    EXPECT_EQ(total(partition, [](const PartShare& share) { return share.particles; }), found.particles);
    EXPECT_EQ(total(partition, [](const PartShare& share) { return share.sent; }),
              total(partition, [](const PartShare& share) { return share.received; }));
    EXPECT_EQ(total(partition, [](const PartShare& share) { return share.destinations; }),
              total(partition, [](const PartShare& share) { return share.sources; }));
  }
  EXPECT_EQ(found.partitions[0].shares[0].received, 0);
  EXPECT_DOUBLE_EQ(found.partitions[0].imbalance(), 1);
  EXPECT_TRUE(found.partitions[3].by_work) << "50 parts of a few cells each cannot be even";
}

TEST(PartitionCheck, FileHoldsEveryPart) {
  const std::string file = partition_csv(study_partitions(scene_of(bar), {2, 3}));
  EXPECT_NE(file.find("# particles=5034\n"), std::string::npos) << file;
  EXPECT_NE(file.find("\nparts,part,particles,candidates,sent,received,destinations,sources\n2,0,"), std::string::npos);
  EXPECT_NE(file.find("\n3,2,"), std::string::npos);
}

}  // namespace
}  // namespace stirsph::testing
