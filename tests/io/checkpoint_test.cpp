// What is written is read back bit for bit, on the same and on other numbers of ranks, and what is damaged is refused.
#include "io/checkpoint.hpp"

#include <gtest/gtest.h>
#include <hdf5.h>

#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>

#include "io/files.hpp"
#include "io/hdf5_file.hpp"
#include "io_fixture.hpp"

namespace stirsph::test {
namespace {

namespace fs = std::filesystem;

/// Rank 1 stays without particles when there are three or more ranks, the last one otherwise.
std::size_t count_on(const Comm& comm) {
  const int empty = comm.size() >= 3 ? 1 : comm.size() - 1;
  return comm.size() > 1 && comm.rank() == empty ? 0 : 11 + 7 * static_cast<std::size_t>(comm.rank());
}

ParticleSet particles_on(const Comm& comm, SpaceLayout layout = layout_of<Cartesian3>()) {
  ParticleSet particles(layout);
  add_fields(particles);
  fill(particles, count_on(comm), static_cast<double>(comm.exclusive_sum(std::int64_t(count_on(comm)))));
  return particles;
}

NamedState some_state() {
  NamedState state;
  state.numbers["clock"] = {1.0 / 3.0, -0.0, std::numeric_limits<double>::denorm_min(), std::nan("7")};
  state.numbers["empty"] = {};
  state.numbers["rigid temperatures"] = std::vector<double>(1000, 301.7);
  state.texts["scene"] = "title = \"größer\"\n" + std::string(100'000, 'x');
  state.texts["nothing"] = "";
  return state;
}

bool same_bits(const std::vector<double>& a, const std::vector<double>& b) {
  return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(double)) == 0);
}

void expect_same_state(const NamedState& a, const NamedState& b) {
  EXPECT_EQ(a.texts, b.texts);
  ASSERT_EQ(a.numbers.size(), b.numbers.size());
  for (const auto& [name, values] : a.numbers) {
    ASSERT_TRUE(b.numbers.contains(name)) << name;
    EXPECT_TRUE(same_bits(values, b.numbers.at(name))) << name;
  }
}

TEST(Checkpoint, IsTheSameBitForBitOnTheSameRanks) {
  const Comm world;
  const ScratchFolder folder;
  for (const SpaceLayout layout : {layout_of<Cartesian3>(), layout_of<PlaneStrain>()}) {
    const ParticleSet written = particles_on(world, layout);
    write_checkpoint(world, folder / "a.h5", written, some_state());
    ParticleSet read(layout);
    add_fields(read);
    expect_same_state(read_checkpoint(world, folder / "a.h5", read), some_state());
    ASSERT_EQ(read.owned(), written.owned());
    for (std::size_t f = 0; f < written.fields().size(); ++f)
      for (std::size_t c = 0; c < written.fields()[f]->components.size(); ++c)
        for (std::size_t i = 0; i < written.owned(); ++i) {
          const double expected = written.fields()[f]->info->checkpoint ? written.fields()[f]->components[c][i] : 0.0;
          ASSERT_EQ(read.fields()[f]->components[c][i], expected) << written.fields()[f]->info->name;
        }
  }
  EXPECT_FALSE(fs::exists(folder / "a.h5.part"));
}

TEST(Checkpoint, IsReadOnAnyOtherNumberOfRanks) {
  const Comm world;
  const ScratchFolder folder;
  for (int writers = 1; writers <= world.size(); ++writers) {
    const FirstRanks group(writers);
    if (group.member()) write_checkpoint(group.comm(), folder / "a.h5", particles_on(group.comm()), some_state());
    world.barrier();
    for (int readers = 1; readers <= world.size(); ++readers) {
      const FirstRanks readers_group(readers);
      if (!readers_group.member()) continue;
      const Comm comm = readers_group.comm();
      ParticleSet read(layout_of<Cartesian3>());
      add_fields(read);
      expect_same_state(read_checkpoint(comm, folder / "a.h5", read), some_state());
      for (std::size_t i = 0; i < read.owned(); ++i) {
        const double id = read[field::id][i];
        double number = 0;
        for (const auto& field : read.fields()) {
          for (std::size_t c = 0; c < field->components.size(); ++c)
            if (field->info->checkpoint && field->info->name != "id") {
              ASSERT_EQ(field->components[c][i], value_of(id, static_cast<int>(c), number)) << field->info->name;
            }
          number += 1;
        }
      }
      std::int64_t expected = 0, sum = 0;
      for (int r = 0; r < writers; ++r)
        expected += writers > 1 && r == (writers >= 3 ? 1 : writers - 1) ? 0 : 11 + 7 * r;
      for (std::size_t i = 0; i < read.owned(); ++i) sum += std::int64_t(read[field::id][i]);
      EXPECT_EQ(comm.sum(std::int64_t(read.owned())), expected);
      EXPECT_EQ(comm.sum(sum), expected * (expected - 1) / 2);  // every id once
      if (readers != writers) {
        EXPECT_LE(std::int64_t(read.owned()), expected / readers + 1);
      }
    }
    world.barrier();
  }
}

TEST(Checkpoint, WithoutAnyParticleIsFine) {
  const Comm world;
  const ScratchFolder folder;
  ParticleSet none(layout_of<Cartesian3>());
  add_fields(none);
  write_checkpoint(world, folder / "a.h5", none, some_state());
  expect_same_state(read_checkpoint(world, folder / "a.h5", none), some_state());
  EXPECT_EQ(none.owned(), 0u);
}

/// Writes a checkpoint, lets the root change the file's bytes and returns the message of reading it.
template <class Damage>
std::string message_after(Damage&& damage) {
  const Comm world;
  const ScratchFolder folder;
  const std::string path = folder / "a.h5";
  write_checkpoint(world, path, particles_on(world), some_state());
  if (world.is_root()) {
    std::ifstream file(path, std::ios::binary);
    std::string bytes{std::istreambuf_iterator<char>(file), {}};
    damage(bytes);
    std::ofstream(path, std::ios::binary | std::ios::trunc) << bytes;
  }
  world.barrier();
  ParticleSet read(layout_of<Cartesian3>());
  add_fields(read);
  return message_of_io_error([&] { read_checkpoint(world, path, read); });
}

TEST(Checkpoint, OneFlippedBitIsNoticed) {
  const double victim = value_of(3, 1, 2);  // velocity, second component, particle 3
  const std::string message = message_after([&](std::string& bytes) {
    const std::size_t place = bytes.find(std::string(reinterpret_cast<const char*>(&victim), sizeof victim));
    ASSERT_NE(place, std::string::npos);
    bytes[place] = static_cast<char>(bytes[place] ^ 1);
  });
  EXPECT_NE(message.find("checksum of particles/velocity"), std::string::npos) << message;
}

TEST(Checkpoint, ExchangedParticlesAreNoticed) {
  const double a = value_of(3, 0, 5), b = value_of(4, 0, 5);  // temperature
  const std::string message = message_after([&](std::string& bytes) {
    const std::size_t at_a = bytes.find(std::string(reinterpret_cast<const char*>(&a), sizeof a));
    const std::size_t at_b = bytes.find(std::string(reinterpret_cast<const char*>(&b), sizeof b));
    ASSERT_TRUE(at_a != std::string::npos && at_b != std::string::npos);
    bytes.replace(at_a, sizeof b, reinterpret_cast<const char*>(&b), sizeof b);
    bytes.replace(at_b, sizeof a, reinterpret_cast<const char*>(&a), sizeof a);
  });
  EXPECT_NE(message.find("checksum of particles/temperature"), std::string::npos) << message;
}

TEST(Checkpoint, AFileCutOffIsNoticed) {
  for (const double part : {0.9, 0.5, 0.01})
    message_after([&](std::string& bytes) { bytes.resize(static_cast<std::size_t>(part * double(bytes.size()))); });
  const std::string message = message_after([](std::string& bytes) { bytes.clear(); });
  EXPECT_NE(message.find("not of this kind"), std::string::npos) << message;
}

/// Whatever byte of the file is damaged: it is refused, or the byte was of no meaning and the same is read.
TEST(Checkpoint, NoDamagedByteGoesThrough) {
  const Comm world, alone(MPI_COMM_SELF);
  const ScratchFolder folder;
  if (!world.is_root()) return;
  const std::string path = folder / "a.h5";
  ParticleSet written(layout_of<Cartesian3>());
  for (const FieldInfo* info : {&field::id, &field::position, &field::temperature}) written.add(*info);
  fill(written, 5, 0);
  const NamedState state{{{"clock", {0.25}}}, {{"scene", "title"}}};
  write_checkpoint(alone, path, written, state);
  std::ifstream file(path, std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(file), {}};
  int refused = 0, tried = 0;
  for (std::size_t place = 0; place < bytes.size(); place += 7, ++tried) {
    std::string damaged = bytes;
    damaged[place] = static_cast<char>(~damaged[place]);
    std::ofstream(path, std::ios::binary | std::ios::trunc) << damaged;
    ParticleSet read(layout_of<Cartesian3>());
    for (const FieldInfo* info : {&field::id, &field::position, &field::temperature}) read.add(*info);
    try {
      expect_same_state(read_checkpoint(alone, path, read), state);
      ASSERT_EQ(read.owned(), written.owned()) << "byte " << place;
      for (std::size_t f = 0; f < read.fields().size(); ++f)
        for (std::size_t c = 0; c < read.fields()[f]->components.size(); ++c)
          for (std::size_t i = 0; i < read.owned(); ++i)
            ASSERT_EQ(read.fields()[f]->components[c][i], written.fields()[f]->components[c][i]) << "byte " << place;
    } catch (const Error& error) {
      ASSERT_EQ(error.code(), ExitCode::Io) << "byte " << place << ": " << error.what();
      ++refused;
    }
  }
  EXPECT_GT(refused, tried / 2);
}

/// Two sound checkpoints, and the numbers of particles per rank of the one in the other.
TEST(Checkpoint, ParticlesPerRankMustFitTheFields) {
  const Comm world;
  const ScratchFolder folder;
  ParticleSet particles = particles_on(world);
  write_checkpoint(world, folder / "a.h5", particles, {});
  particles.resize_owned(particles.owned() + 2);
  write_checkpoint(world, folder / "b.h5", particles, {});
  if (world.is_root()) {
    const hid_t a = H5Fopen((folder / "a.h5").c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
    const hid_t b = H5Fopen((folder / "b.h5").c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
    const char* const dataset = "partition/particles_per_rank";
    EXPECT_GE(H5Ldelete(a, dataset, H5P_DEFAULT), 0);
    EXPECT_GE(H5Ocopy(b, dataset, a, dataset, H5P_DEFAULT, H5P_DEFAULT), 0);
    H5Fclose(b);
    H5Fclose(a);
  }
  world.barrier();
  const std::string message = message_of_io_error([&] { read_checkpoint(world, folder / "a.h5", particles); });
  EXPECT_NE(message.find("not the number of particles"), std::string::npos) << message;
}

/// An attribute of several texts, where one is expected, must not be written past the end of that one.
TEST(Checkpoint, AListOfTextsIsNoText) {
  const Comm world;
  const ScratchFolder folder;
  const std::string path = folder / "a.h5";
  Hdf5File(world, path, Hdf5File::Mode::Create).close();
  if (world.is_root()) {
    const hid_t file = H5Fopen(path.c_str(), H5F_ACC_RDWR, H5P_DEFAULT), type = H5Tcopy(H5T_C_S1);
    H5Tset_size(type, 20);
    const hsize_t count = 50;
    const hid_t space = H5Screate_simple(1, &count, nullptr);
    H5Aclose(H5Acreate2(file, "format", type, space, H5P_DEFAULT, H5P_DEFAULT));
    H5Sclose(space);
    H5Tclose(type);
    H5Fclose(file);
  }
  world.barrier();
  ParticleSet particles = particles_on(world);
  const std::string message = message_of_io_error([&] { read_checkpoint(world, path, particles); });
  EXPECT_NE(message.find("read the attribute format"), std::string::npos) << message;
}

TEST(Checkpoint, OtherFilesAreRefused) {
  const Comm world;
  const ScratchFolder folder;
  ParticleSet particles(layout_of<Cartesian3>());
  add_fields(particles);
  const auto message = [&](const std::string& name) {
    return message_of_io_error([&] { read_checkpoint(world, folder / name, particles); });
  };
  EXPECT_NE(message("absent.h5").find("No such file"), std::string::npos);
  Hdf5File(world, folder / "other.h5", Hdf5File::Mode::Create).close();
  EXPECT_NE(message("other.h5").find("not a checkpoint"), std::string::npos);
  {
    Hdf5File file(world, folder / "half.h5", Hdf5File::Mode::Create);
    file.set_attribute("/", "format", "stirsph checkpoint");
    file.set_attribute("/", "format_version", std::int64_t(1));
    file.close();
  }
  EXPECT_NE(message("half.h5").find("incomplete"), std::string::npos);
  write_checkpoint(world, folder / "plane.h5", particles_on(world, layout_of<PlaneStrain>()), {});
  EXPECT_NE(message("plane.h5").find("another space"), std::string::npos);
}

TEST(Checkpoint, FieldsMustAgree) {
  const Comm world;
  const ScratchFolder folder;
  const std::string path = folder / "a.h5";
  write_checkpoint(world, path, particles_on(world), {});
  ParticleSet more(layout_of<Cartesian3>());
  add_fields(more);
  more.add(field::heat_input);
  std::string message = message_of_io_error([&] { read_checkpoint(world, path, more); });
  EXPECT_NE(message.find("no field 'heat_input'"), std::string::npos) << message;
  ParticleSet fewer(layout_of<Cartesian3>());
  for (const FieldInfo* info : {&field::id, &field::position, &field::velocity, &field::stress_deviator})
    fewer.add(*info);
  message = message_of_io_error([&] { read_checkpoint(world, path, fewer); });
  EXPECT_NE(message.find("has the field 'temperature'"), std::string::npos) << message;
  EXPECT_NO_THROW(read_checkpoint(world, path, fewer, {"temperature", "volume"}));
}

TEST(Checkpoint, TheTwoNewestAreKeptAndADamagedOneIsPassedOver) {
  const Comm world;
  const ScratchFolder folder;
  const ParticleSet particles = particles_on(world);
  EXPECT_EQ(find_newest_checkpoint(world, folder.path()), "");
  EXPECT_EQ(find_newest_checkpoint(world, folder / "absent"), "");
  for (const int step : {5, 90, 1000, 20'000}) {
    write_checkpoint(world, checkpoint_path(folder.path(), step), particles, {});
    keep_newest_checkpoints(world, folder.path(), 2);
  }
  if (world.is_root()) {
    std::ofstream(checkpoint_path(folder.path(), 30'000) + ".part") << "left by a killed run";
    std::ofstream(folder / "checkpoint_notes.h5") << "not ours";
  }
  world.barrier();
  EXPECT_EQ(checkpoint_path(folder.path(), 90), folder / "checkpoint_000000090.h5");
  EXPECT_EQ(checkpoint_step(folder / "checkpoint_000000090.h5"), 90);
  EXPECT_EQ(checkpoint_step(folder / "checkpoint_notes.h5"), -1);
  EXPECT_FALSE(fs::exists(checkpoint_path(folder.path(), 5)));
  EXPECT_FALSE(fs::exists(checkpoint_path(folder.path(), 90)));
  EXPECT_EQ(find_newest_checkpoint(world, folder.path()), checkpoint_path(folder.path(), 20'000));

  const std::string newest = checkpoint_path(folder.path(), 20'000);
  world.barrier();
  if (world.is_root()) fs::resize_file(newest, fs::file_size(newest) / 2);
  world.barrier();
  EXPECT_EQ(find_newest_checkpoint(world, folder.path()), checkpoint_path(folder.path(), 1000));
  write_checkpoint(world, checkpoint_path(folder.path(), 2000), particles, {});
  keep_newest_checkpoints(world, folder.path(), 2);
  world.barrier();
  EXPECT_FALSE(fs::exists(newest));
  EXPECT_FALSE(fs::exists(checkpoint_path(folder.path(), 30'000) + ".part"));
  EXPECT_TRUE(fs::exists(checkpoint_path(folder.path(), 1000)));
  EXPECT_TRUE(fs::exists(checkpoint_path(folder.path(), 2000)));
  EXPECT_TRUE(fs::exists(folder / "checkpoint_notes.h5"));

  world.barrier();  // the others have looked before the root moves the file of step 2000
  set_aside_checkpoints_after(world, folder.path(), 1000);
  EXPECT_EQ(find_newest_checkpoint(world, folder.path()), checkpoint_path(folder.path(), 1000));
}

}  // namespace
}  // namespace stirsph::test
