/// What the two fuzzers of checkpoints share: a file in memory, and a reader that may refuse it with an IoError only.
#pragma once

#include <mpi.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>

#include "base/comm.hpp"
#include "base/error.hpp"
#include "io/checkpoint.hpp"
#include "io/files.hpp"
#include "particles/field_names.hpp"
#include "particles/particle_set.hpp"

namespace stirsph::fuzz {

/// Where the file of each execution lies: in memory where that is possible, as it would wear a disk.
inline const std::string& file_name() {
  static const std::string name = [] {
    const char* const folder = std::filesystem::is_directory("/dev/shm") ? "/dev/shm" : "/tmp";
    std::atexit([] { std::remove(file_name().c_str()); });
    return std::string(folder) + "/stirsph_fuzz_" + std::to_string(::getpid()) + ".h5";
  }();
  return name;
}

inline ParticleSet particles_with_fields() {
  ParticleSet particles(layout_of<Cartesian3>());
  for (const FieldInfo* info : {&field::id, &field::position, &field::temperature}) particles.add(*info);
  return particles;
}

inline void start_mpi() {
  skip_display_probes();
  choose_mpi_io();
  MPI_Init(nullptr, nullptr);
}

/// All exceptions but IoError are bugs, and end the fuzzer.
inline void read_or_refuse() {
  ParticleSet particles = particles_with_fields();
  try {
    read_checkpoint(Comm(), file_name(), particles);
  } catch (const Error& error) {
    if (error.code() != ExitCode::Io) throw;
  }
}

}  // namespace stirsph::fuzz
