/// G3 of the verification catalogue: stop at half, restart, and end in the same state.
#include <gtest/gtest.h>

#include <cstring>
#include <filesystem>

#include "io/checkpoint.hpp"
#include "support/scene_run.hpp"

namespace stirsph::testing {
namespace {

constexpr int half_way = 63, all = 120;  // half way lies between two heat solves (every 5 steps)

std::string scratch(const Comm& comm, const std::string& name) {
  const std::string folder = std::string(STIRSPH_BINARY_DIR) + "/restart_test_" + std::to_string(comm.size());
  if (comm.is_root()) std::filesystem::create_directories(folder);
  comm.barrier();
  return folder + "/" + name;
}

void advance(Simulation& simulation, int to) {
  while (simulation.clock().step < to) simulation.step();
}

/// Bitwise comparison of all state, in storage order.
void expect_identical(Simulation& a, Simulation& b) {
  ASSERT_EQ(a.particles().owned(), b.particles().owned());
  for (const auto& field : a.particles().fields()) {
    if (!field->info->checkpoint) continue;
    for (std::size_t c = 0; c < field->components.size(); ++c) {
      const auto left = a.particles().component(*field->info, static_cast<int>(c));
      const auto right = b.particles().component(*field->info, static_cast<int>(c));
      EXPECT_EQ(0, std::memcmp(left.data(), right.data(), a.particles().owned() * sizeof(double)))
          << field->info->name << " component " << c;
    }
  }
  EXPECT_EQ(a.named_state().numbers, b.named_state().numbers);
}

/// A scene and what is changed in it.
struct Case {
  const char* scene;
  std::vector<std::string> overrides{};
};

class RestartOf : public ::testing::TestWithParam<Case> {};

TEST_P(RestartOf, IsBitwiseOnTheSameRanksG3) {
  const Comm comm;
  const std::string path = scratch(comm, GetParam().scene + std::to_string(GetParam().overrides.size()) + ".h5");
  const std::string scene = verification_scene(GetParam().scene);
  const auto straight = started(scene, GetParam().overrides);
  advance(*straight, half_way);
  write_checkpoint(comm, path, straight->particles(), straight->named_state());
  const std::size_t pairs_half_way = straight->neighbourhood().pairs().size();
  advance(*straight, all);

  Simulation resumed(comm, read_scene(scene, GetParam().overrides));
  resumed.resume(path);
  EXPECT_EQ(resumed.clock().step, half_way);
  EXPECT_EQ(resumed.neighbourhood().pairs().size(), pairs_half_way) << "the list is that of its build, not a new one";
  advance(resumed, all);
  expect_identical(*straight, resumed);
}

INSTANTIATE_TEST_SUITE_P(
    G3, RestartOf,
    ::testing::Values(Case{"mini_tube"}, Case{"meshed_tube"}, Case{"spinning_block"},
                      Case{"plane_shear", {"grip.1.velocity.x=\"50 m/s\""}},
                      Case{"mini_tube",
                           {"numerics.gradient_correction=full", "time.cfl=0.3", "numerics.hourglass_control=1",
                            "numerics.viscosity_reconstruction=true", "numerics.density_reconstruction=true"}}));

/// What the last partition reached decides on the next one: a run that forgot it would cut again.
TEST(Restart, RemembersWhatThePartitionReachedG3) {
  const Comm comm;
  if (comm.size() != 3) GTEST_SKIP() << "the scene is even on two ranks and cannot be on three";
  const std::string path = scratch(comm, "repartition.h5");
  const std::vector<std::string> often{"numerics.repartition_imbalance=1.01", "numerics.skin=0.03"};
  const auto straight = started(verification_scene("mini_tube"), often);
  while (straight->list_upkeep().repartitions == 0 && straight->clock().step < half_way) straight->step();
  ASSERT_EQ(straight->list_upkeep().repartitions, 1);
  write_checkpoint(comm, path, straight->particles(), straight->named_state());
  advance(*straight, all);
  const long cuts = straight->list_upkeep().repartitions, lists = straight->list_upkeep().renewals;
  const double imbalance = straight->imbalance();
  if (comm.is_root()) std::printf("%ld partitions, %ld lists, imbalance at the end %.3f\n", cuts, lists, imbalance);
  EXPECT_GT(imbalance, 1.01) << "METIS reaches the limit: choose another scene";
  EXPECT_LT(cuts, lists / 2) << "cut in vain";
  Simulation resumed(comm, read_scene(verification_scene("mini_tube"), often));
  resumed.resume(path);
  advance(resumed, all);
  EXPECT_EQ(resumed.list_upkeep().repartitions, cuts - 1);
  expect_identical(*straight, resumed);
}

/// The next step renews the pair list, and so must that of the continued run.
TEST(Restart, WhenTheListHasJustExpiredG3) {
  const Comm comm;
  const std::string path = scratch(comm, "expired.h5");
  const auto straight = started(verification_scene("spinning_block"));
  const auto expired = [&] { return straight->named_state().numbers.at("step_state").at(4) != 0; };
  while (!expired() && straight->clock().step < 1000) straight->step();
  ASSERT_TRUE(expired());
  write_checkpoint(comm, path, straight->particles(), straight->named_state());
  Simulation resumed(comm, read_scene(verification_scene("spinning_block")));
  resumed.resume(path);
  straight->step();
  resumed.step();
  expect_identical(*straight, resumed);
}

TEST(RestartOnOtherRanks, AgreesByIdG3) {
  const Comm world;
  if (world.size() < 2) GTEST_SKIP() << "needs two ranks";
  // Written on all ranks, continued on the first rank alone.
  const std::string path = scratch(world, "other_ranks.h5");
  const auto straight = started(verification_scene("spinning_block"));
  advance(*straight, half_way);
  write_checkpoint(world, path, straight->particles(), straight->named_state());
  advance(*straight, all);
  const auto expected_x = gathered(*straight, field::position), expected_v = gathered(*straight, field::velocity);
  if (world.is_root()) {
    Simulation alone(Comm(MPI_COMM_SELF), read_scene(verification_scene("spinning_block")));
    alone.resume(path);
    advance(alone, all);
    const auto x = gathered(alone, field::position), v = gathered(alone, field::velocity);
    double worst = 0;
    for (std::size_t i = 0; i < x.size(); ++i)
      worst = std::max({worst, std::abs(x[i] - expected_x[i]) / 0.01, std::abs(v[i] - expected_v[i]) / 30});
    std::printf("G3, restart on another rank count: largest relative difference %.1e\n", worst);
    EXPECT_LT(worst, 1e-11);  // round-off of 60 steps; the catalogue allows 1e-10 after 1000
  }
  world.barrier();
}

/// Meshes are made anew and shared out otherwise; temperatures of their nodes, heat on its way and ledgers go on.
TEST(RestartOnOtherRanks, KeepsTheHeatOfMeshesG3) {
  const Comm world;
  const std::string path = scratch(world, "meshes.h5");
  const auto straight = started(verification_scene("meshed_tube"));
  advance(*straight, half_way);
  write_checkpoint(world, path, straight->particles(), straight->named_state());
  advance(*straight, all);
  const auto expected = gathered(*straight, field::temperature);
  const Diagnostics expected_row = diagnose(*straight);
  if (world.is_root()) {
    Simulation alone(Comm(MPI_COMM_SELF), read_scene(verification_scene("meshed_tube")));
    alone.resume(path);
    advance(alone, all);
    const auto temperature = gathered(alone, field::temperature);
    double worst = 0;  // K
    for (std::size_t i = 0; i < temperature.size(); ++i)
      worst = std::max(worst, std::abs(temperature[i] - expected[i]));
    for (std::size_t r = 0; r < alone.rigids().size(); ++r) {
      const RigidHeat &mine = alone.rigid_heat()[r], &theirs = straight->rigid_heat()[r];
      ASSERT_EQ(mine.node_temperature.size(), theirs.node_temperature.size());
      for (std::size_t n = 0; n < mine.node_temperature.size(); ++n)
        worst = std::max(worst, std::abs(mine.node_temperature[n] - theirs.node_temperature[n]));
      const BodyHeat &got = alone.heat_ledger().bodies[r], &wanted = straight->heat_ledger().bodies[r];
      EXPECT_NEAR(got.interface, wanted.interface, 1e-8 * std::abs(wanted.interface));
      EXPECT_NEAR(got.surface, wanted.surface, 1e-8 * std::abs(wanted.surface));
      EXPECT_NEAR(got.friction, wanted.friction, 1e-8 * std::abs(wanted.friction));
    }
    EXPECT_GT(straight->heat_ledger().bodies[0].friction, 0) << "the tool rubs";
    EXPECT_LT(std::abs(alone.heat_ledger().residual()), 1e-12);
    const Diagnostics row = diagnose(alone);
    ASSERT_EQ(row.probes.size(), expected_row.probes.size());
    for (std::size_t p = 0; p < row.probes.size(); ++p) EXPECT_NEAR(row.probes[p], expected_row.probes[p], 1e-9);
    std::printf("G3, meshes after a restart on another rank count: largest difference %.1e K\n", worst);
    EXPECT_LT(worst, 1e-9);  // round-off of 60 steps and the tolerance of the heat solve, 1e-10 of rises below 10 K
  }
  world.barrier();
}

TEST(RestartOnOtherRanks, KeepsLedgersAndBodies) {
  const Comm world;
  const std::string path = scratch(world, "ledgers.h5");
  const auto straight = started(verification_scene("mini_tube"));
  advance(*straight, half_way);
  write_checkpoint(world, path, straight->particles(), straight->named_state());
  const Diagnostics before = diagnose(*straight);
  if (world.is_root()) {
    Simulation alone(Comm(MPI_COMM_SELF), read_scene(verification_scene("mini_tube")));
    alone.resume(path);
    const Diagnostics after = diagnose(alone);
    EXPECT_NEAR(after.energy.friction, before.energy.friction, 1e-12 * std::abs(before.energy.friction));
    EXPECT_NEAR(after.energy.external, before.energy.external, 1e-12 * std::abs(before.energy.external));
    EXPECT_EQ(alone.rigids()[0].pose.angle, straight->rigids()[0].pose.angle);
    EXPECT_EQ(alone.rigid_heat()[0].temperature, straight->rigid_heat()[0].temperature);
  }
  world.barrier();
}

}  // namespace
}  // namespace stirsph::testing
