/// What the tests of io/ share: a scratch folder, communicators of fewer ranks, particles with recognisable values.
#pragma once

#include <gtest/gtest.h>
#include <mpi.h>
#include <stdlib.h>

#include <filesystem>
#include <string>

#include "base/comm.hpp"
#include "base/error.hpp"
#include "particles/field_names.hpp"
#include "particles/particle_set.hpp"

namespace stirsph::test {

/// A folder that exists on all ranks' view of the disk and is removed at the end.
class ScratchFolder {
 public:
  ScratchFolder() {
    std::string name;
    if (world_.is_root()) {
      std::string pattern = (std::filesystem::temp_directory_path() / "stirsph_io_XXXXXX").string();
      if (::mkdtemp(pattern.data())) name = pattern;
    }
    path_ = world_.broadcast(name);
  }
  ~ScratchFolder() {
    world_.barrier();
    std::error_code ignored;
    if (world_.is_root()) std::filesystem::remove_all(path_, ignored);
  }
  const std::string& path() const { return path_; }
  std::string operator/(const std::string& name) const { return path_ + "/" + name; }

 private:
  Comm world_;
  std::string path_;
};

/// The first `ranks` ranks of the world as a communicator of their own.
class FirstRanks {
 public:
  explicit FirstRanks(int ranks) {
    const int rank = Comm().rank();
    MPI_Comm_split(MPI_COMM_WORLD, rank < ranks ? 0 : 1, rank, &handle_);
    member_ = rank < ranks;
  }
  ~FirstRanks() { MPI_Comm_free(&handle_); }
  bool member() const { return member_; }
  Comm comm() const { return Comm(handle_); }

 private:
  MPI_Comm handle_ = MPI_COMM_NULL;
  bool member_ = false;
};

inline void add_fields(ParticleSet& particles) {
  for (const FieldInfo* info : {&field::id, &field::position, &field::velocity, &field::stress_deviator, &field::stress,
                                &field::temperature, &field::volume})
    particles.add(*info);
}

/// A value that tells particle and component apart and has a full mantissa.
inline double value_of(double id, int component, double field) {
  return (id + 1) / 3.0 + component * 1e3 + field * 1e6;
}

/// `count` particles with ids from `first` in descending order, so that the order on the rank is not that of the ids.
inline void fill(ParticleSet& particles, std::size_t count, double first) {
  particles.resize_owned(count);
  for (std::size_t i = 0; i < count; ++i) {
    const double id = first + static_cast<double>(count - 1 - i);
    double number = 0;
    for (const auto& field : particles.fields()) {
      for (std::size_t c = 0; c < field->components.size(); ++c)
        field->components[c][i] = value_of(id, static_cast<int>(c), number);
      number += 1;
    }
    particles[field::id][i] = id;
  }
}

/// Runs `work`, which must fail, and returns the error; collective work must fail on every rank.
template <class Work>
std::string message_of_io_error(Work&& work) {
  try {
    work();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::Io) << error.what();
    return error.what();
  }
  ADD_FAILURE() << "nothing was thrown";
  return {};
}

}  // namespace stirsph::test
