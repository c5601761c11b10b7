/// Microstructure in whole runs: the fields of a driven shear, step size, outputs, restart, ranks, and nothing when
/// off.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <filesystem>

#include "driver/particle_values.hpp"
#include "driver/run.hpp"
#include "microstructure/grain.hpp"
#include "support/scene_run.hpp"

namespace stirsph::testing {
namespace {

const std::vector<std::string> mini_grains{"microstructure.window=1 ms"};

std::string scratch(const Comm& comm, const std::string& name) {
  const std::string folder =
      std::string(STIRSPH_BINARY_DIR) + "/microstructure_run_test_" + std::to_string(comm.size());
  if (comm.is_root()) std::filesystem::create_directories(folder);
  comm.barrier();
  return folder + "/" + name;
}

TEST(MicrostructureRun, FieldsOfADrivenShear) {
  // Constant rate, so that every window after yielding holds rate/sqrt(3).
  const auto run = started(verification_scene("grain_shear"), {"grip.0.velocity.x=2000*y"});
  run_to_end(*run);
  const auto rate = gathered(*run, field::strain_rate_average), grain = gathered(*run, field::grain_size),
             flag = gathered(*run, field::recrystallised), temperature = gathered(*run, field::temperature);
  const GrainLaw law = *run->scene().materials[0].grain;
  int cold = 0, hot = 0;
  for (std::size_t i = 0; i < rate.size(); ++i) {
    EXPECT_NEAR(rate[i], 2000 / std::sqrt(3.0), 1e-3 * rate[i]);  // elastic strain of the rotating stress
    if (temperature[i] < 500) {
      ++cold;
      EXPECT_EQ(flag[i], 0);
      EXPECT_EQ(grain[i], law.initial_grain_size);
    } else {
      ++hot;
      EXPECT_EQ(flag[i], 1);
      EXPECT_NEAR(grain[i], 1e-6 * *recrystallised_grain_size(law, rate[i], temperature[i]), 1e-15);
    }
  }
  EXPECT_GT(cold, 0);
  EXPECT_GT(hot, 0);
  const Diagnostics d = diagnose(*run);
  double mean = 0, finest = 1;
  for (const double g : grain) mean += g / static_cast<double>(grain.size()), finest = std::min(finest, g);
  EXPECT_NEAR(d.probes[0], mean, 1e-12 * mean);
  EXPECT_NEAR(d.probes[1], hall_petch_hardness(law, 1e6 * finest), 1e-9);
}

/// Largest relative difference of the grain sizes of two runs, and how many particles recrystallised in one only.
std::pair<double, int> difference(const Simulation& a, const Simulation& b, double* mean = nullptr) {
  const auto first = gathered(a, field::grain_size), second = gathered(b, field::grain_size);
  const auto here = gathered(a, field::recrystallised), there = gathered(b, field::recrystallised);
  double worst = 0, sum = 0;
  int flips = 0;
  for (std::size_t i = 0; i < first.size(); ++i) {
    flips += here[i] != there[i];
    worst = std::max(worst, std::abs(first[i] / second[i] - 1));
    sum += std::abs(first[i] / second[i] - 1);
  }
  if (mean) *mean = sum / static_cast<double>(first.size());
  return {worst, flips};
}

TEST(MicrostructureRun, HalfTheStepGivesTheSameMap) {
  const auto coarse = started(verification_scene("grain_shear")),
             fine = started(verification_scene("grain_shear"), {"time.cfl=0.15"});
  run_to_end(*coarse);
  run_to_end(*fine);
  const auto [worst, flips] = difference(*coarse, *fine);
  std::printf("driven shear, half the step: largest difference %.1e\n", worst);
  EXPECT_EQ(flips, 0);
  EXPECT_LT(worst, 1e-5);  // the motion is driven: only rounding and the path of the stress differ

  // A process in which half the step changes the strains themselves by 10 %.
  const auto mini = started(verification_scene("mini_tube"), mini_grains),
             mini_fine = started(verification_scene("mini_tube"), {mini_grains[0], "time.cfl=0.25"});
  run_to_end(*mini);
  run_to_end(*mini_fine);
  double mean = 0;
  const auto [mini_worst, mini_flips] = difference(*mini, *mini_fine, &mean);
  std::printf("mini tube, half the step: mean difference %.1e, largest %.1e, %d flips\n", mean, mini_worst, mini_flips);
  EXPECT_EQ(mini_flips, 0);
  EXPECT_LT(mean, 0.01);
}

TEST(MicrostructureRun, OutputsChangeNothing) {
  const Comm comm;
  const std::string path[] = {scratch(comm, "seldom"), scratch(comm, "often")};
  for (int k = 0; k < 2; ++k) {
    const Scene scene = read_scene(
        verification_scene("grain_shear"),
        {k ? "output.snapshot_interval=7 us" : "output.snapshot_interval=14 us",
         k ? "output.history_interval=1 us" : "output.history_interval=2 us", "output.checkpoint_steps=1000000"});
    RunOptions options;
    options.folder = path[k];
    options.quiet = true;
    ASSERT_EQ(run_scene(comm, scene, options), ExitCode::Finished);
  }
  Simulation seldom(comm, read_scene(verification_scene("grain_shear"))),
      often(comm, read_scene(verification_scene("grain_shear")));
  seldom.resume(find_newest_checkpoint(comm, path[0]));
  often.resume(find_newest_checkpoint(comm, path[1]));
  EXPECT_TRUE(seldom.finished());
  EXPECT_EQ(gathered(seldom, field::grain_size), gathered(often, field::grain_size));
  EXPECT_EQ(gathered(seldom, field::position), gathered(often, field::position));
}

TEST(MicrostructureRun, RestartIsExact) {
  const Comm comm;
  const std::string path = scratch(comm, "grains.h5");
  const auto straight = started(verification_scene("mini_tube"), mini_grains);
  while (straight->clock().step < 63) straight->step();
  write_checkpoint(comm, path, straight->particles(), straight->named_state());
  run_to_end(*straight);
  Simulation resumed(comm, read_scene(verification_scene("mini_tube"), mini_grains));
  resumed.resume(path);
  run_to_end(resumed);
  for (const FieldInfo* info : {&field::grain_size, &field::recrystallised, &field::strain_rate_average})
    EXPECT_EQ(gathered(*straight, *info), gathered(resumed, *info)) << info->name;
}

TEST(MicrostructureRun, RanksAgree) {
  const Comm world;
  if (world.size() < 2) GTEST_SKIP() << "needs two ranks";
  const auto together = started(verification_scene("grain_shear"));
  run_to_end(*together);
  const auto grain = gathered(*together, field::grain_size), flag = gathered(*together, field::recrystallised);
  const Diagnostics d = diagnose(*together);
  if (world.is_root()) {
    const auto alone = started(verification_scene("grain_shear"), {}, Comm(MPI_COMM_SELF));
    run_to_end(*alone);
    const auto mine = gathered(*alone, field::grain_size);
    for (std::size_t i = 0; i < mine.size(); ++i) EXPECT_NEAR(mine[i], grain[i], 1e-12 * grain[i]);
    EXPECT_EQ(gathered(*alone, field::recrystallised), flag);
    EXPECT_NEAR(diagnose(*alone).probes[0], d.probes[0], 1e-12 * d.probes[0]);
  }
  world.barrier();
}

TEST(MicrostructureRun, NoFieldsWhenOff) {
  const auto off = started(verification_scene("mini_tube")), on = started(verification_scene("mini_tube"), mini_grains);
  for (const FieldInfo* info : {&field::grain_size, &field::recrystallised, &field::strain_rate_average,
                                &field::strain_at_window_start, &field::initial_position}) {
    EXPECT_FALSE(off->particles().has(*info)) << info->name;
    EXPECT_EQ(on->particles().has(*info), info != &field::initial_position) << info->name;
  }
  for (const DerivedQuantity& quantity : derived_quantities(off->scene())) EXPECT_NE(quantity.name, "hardness");
  EXPECT_LT(off->particles().bytes(), on->particles().bytes());
}

}  // namespace
}  // namespace stirsph::testing
