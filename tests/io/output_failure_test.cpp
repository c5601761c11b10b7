// A result that cannot be written is an Io error on every rank: nobody hangs, nothing half-written keeps the final
// name.
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <filesystem>
#include <fstream>

#include "io/checkpoint.hpp"
#include "io/files.hpp"
#include "io/hdf5_file.hpp"
#include "io_fixture.hpp"

namespace stirsph::test {
namespace {

namespace fs = std::filesystem;

/// Limits the size of files this process may write, as `ulimit -f` and a full disk do.
class FileSizeLimit {
 public:
  explicit FileSizeLimit(rlim_t bytes) {
    choose_mpi_io();  // turns the limit's signal into an error
    getrlimit(RLIMIT_FSIZE, &before_);
    rlimit limit = before_;
    limit.rlim_cur = bytes;
    setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~FileSizeLimit() { setrlimit(RLIMIT_FSIZE, &before_); }

 private:
  rlimit before_{};
};

ParticleSet many_particles() {
  const Comm world;
  ParticleSet particles(layout_of<Cartesian3>());
  add_fields(particles);
  fill(particles, 5000, 5000.0 * world.rank());
  return particles;
}

TEST(OutputFailure, AFolderThatCannotBe) {
  const Comm world;
  const ScratchFolder folder;
  if (world.is_root()) std::ofstream(folder / "file") << "a regular file";
  world.barrier();
  const std::string path = folder / "file/checkpoint_000000001.h5";
  const std::string message = message_of_io_error([&] { write_checkpoint(world, path, many_particles(), {}); });
  EXPECT_NE(message.find(path), std::string::npos) << message;
  EXPECT_NE(message.find("Not a directory"), std::string::npos) << message;
  EXPECT_NE(message.find("check that the folder"), std::string::npos) << message;
  EXPECT_THROW(make_folder(folder / "file/below"), IoError);
  EXPECT_THROW(write_text_file(folder / "file/text", "text"), IoError);
}

TEST(OutputFailure, NoRoomIsNoticedBeforeWriting) {
  const Comm world;
  const ScratchFolder folder;
  const std::string path = folder / "checkpoint_000000001.h5";
  const ParticleSet particles = many_particles();
  write_checkpoint(world, path, particles, {});
  const auto size_before = fs::file_size(path);
  world.barrier();
  {
    const FileSizeLimit limit(100'000);
    const std::string message = message_of_io_error([&] { write_checkpoint(world, path, particles, {}); });
    EXPECT_NE(message.find("File too large"), std::string::npos) << message;
  }
  world.barrier();
  EXPECT_EQ(fs::file_size(path), size_before);
  EXPECT_FALSE(fs::exists(path + ".part"));
  EXPECT_EQ(find_newest_checkpoint(world, folder.path()), path);  // the older file of that name is untouched
}

TEST(OutputFailure, NoRoomWhileWritingStopsAllRanks) {
  const Comm world;
  const ScratchFolder folder;
  const std::vector<double> values(50'000, 1.0 + world.rank());
  {
    const FileSizeLimit limit(100'000);
    message_of_io_error([&] {
      Hdf5File file(world, folder / "a.h5", Hdf5File::Mode::Create);
      file.write_rows<double>("values", values);
      file.flush();
      file.close();
    });
  }
  // MPI and HDF5 are still usable: the program goes on to say what happened and to leave in order.
  Hdf5File file(world, folder / "b.h5", Hdf5File::Mode::Create);
  file.write_rows<double>("values", values);
  EXPECT_EQ(file.rows("values"), 50'000 * world.size());
  file.close();
}

TEST(OutputFailure, AFullDeviceStopsTextFiles) { EXPECT_THROW(write_text_file("/dev/full/no", "x"), IoError); }

}  // namespace
}  // namespace stirsph::test
