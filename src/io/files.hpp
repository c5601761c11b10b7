/// File-system steps that results and checkpoints share: every one checked, every message with path, cause and remedy.
#pragma once

#include <cstdint>
#include <string>

namespace stirsph {

/// To be called by a program once, before MPI_Init. Picks ROMIO as the MPI-IO layer of Open MPI unless the user chose
/// one (OMPI_MCA_io in the environment or `mpirun --mca io`), because collective HDF5 writes through Open MPI's own
/// OMPIO have hung and corrupted files (src/io/README.md). Also makes exceeding a file-size limit (ulimit -f) an error
/// with a message instead of a signal that kills the program.
void choose_mpi_io();

/// The advice that ends every message about a failed write.
inline constexpr const char* write_advice =
    "check that the folder exists and is writable and that neither disk nor quota is full";

/// Throws IoError("cannot <action> <path>: <system message>; <write_advice>") for an errno value.
[[noreturn]] void throw_write_error(const std::string& action, const std::string& path, int error_number);

/// Creates a folder and its parents; an existing one is fine.
void make_folder(const std::string& folder);

/// Asks the system for `bytes` of room in an existing file without changing its length, so that a full disk is noticed
/// before the parallel write begins and cannot stop it half-way. File systems that cannot reserve room pass.
void reserve_room(const std::string& path, std::int64_t bytes);

/// Waits until the contents of `temporary` are on the disk, renames it to `path` in one step and makes the rename
/// itself durable: after a crash, `path` is either the old file or the complete new one.
void publish_file(const std::string& temporary, const std::string& path);

/// Writes a whole text file through a temporary name and publish_file.
void write_text_file(const std::string& path, const std::string& text);

/// Deletes a file if it is there; failing to is not an error.
void remove_quietly(const std::string& path) noexcept;

}  // namespace stirsph
