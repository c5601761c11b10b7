// history.csv: header, rows readable at once, and on restart neither a gap nor a row twice.
#include "io/history.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <iterator>

#include "io_fixture.hpp"

namespace stirsph::test {
namespace {

const std::vector<HistoryColumn> columns{{"tool.force_z", "N"}, {"T_max", "K"}};

std::string contents(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

TEST(History, RowsCanBeReadWhileTheRunGoesOn) {
  const Comm world;
  const ScratchFolder folder;
  const std::string path = folder / "history.csv";
  History history = History::begin(world.is_root(), path, columns);
  history.write(0.1, {1.0 / 3.0, 300});
  world.barrier();
  EXPECT_EQ(contents(path), "time [s],tool.force_z [N],T_max [K]\n0.1,0.3333333333,300\n");
}

TEST(History, RestartDropsLaterRowsAndContinues) {
  const Comm world;
  const ScratchFolder folder;
  const std::string path = folder / "history.csv";
  std::string expected;
  const double dt = 1.0 / 7.0;
  {
    History straight = History::begin(world.is_root(), folder / "straight.csv", columns);
    for (int k = 0; k < 10; ++k) straight.write(k * dt, {1.0 * k, 2.0 * k});
    History history = History::begin(world.is_root(), path, columns);
    for (int k = 0; k < 9; ++k) history.write(k * dt, {1.0 * k, 2.0 * k});
  }
  if (world.is_root()) std::ofstream(path, std::ios::app) << "1.28,4";  // killed in mid-row
  world.barrier();
  History history = History::resume(world.is_root(), path, columns, 5 * dt);
  for (int k = 6; k < 10; ++k) history.write(k * dt, {1.0 * k, 2.0 * k});
  world.barrier();
  EXPECT_EQ(contents(path), contents(folder / "straight.csv"));
}

TEST(History, OtherColumnsAreRefusedByName) {
  const Comm world;
  const ScratchFolder folder;
  const std::string path = folder / "history.csv";
  History::begin(world.is_root(), path, columns).write(0, {1, 2});
  if (!world.is_root()) return;
  const std::vector<HistoryColumn> other{{"tool.force_z", "N"}, {"tool.torque", "N m"}};
  const std::string message = message_of_io_error([&] { History::resume(true, path, other, 0); });
  EXPECT_NE(message.find("only in the file: 'T_max [K]'"), std::string::npos) << message;
  EXPECT_NE(message.find("only in this scene: 'tool.torque [N m]'"), std::string::npos) << message;
}

TEST(History, AFullDiskIsAnError) {
  History history;
  EXPECT_THROW(history = History::begin(true, "/dev/full", columns), IoError);
  EXPECT_THROW(history = History::begin(true, "/dev/null/history.csv", columns), IoError);
}

}  // namespace
}  // namespace stirsph::test
