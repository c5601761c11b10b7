/// The complete state of a run in one HDF5 file, from which it continues bit for bit.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "base/comm.hpp"
#include "particles/particle_set.hpp"

namespace stirsph {

/// State that is not a particle field, alike on all ranks: clock, controllers, ledgers, temperatures of rigid bodies,
/// the effective input, the code version. Names are free but must not contain '/'.
struct NamedState {
  std::map<std::string, std::vector<double>> numbers;
  std::map<std::string, std::string> texts;
};

/// FOLDER/checkpoint_000001234.h5
std::string checkpoint_path(const std::string& folder, std::int64_t step);
/// The step in the name of such a file; -1 for any other name.
std::int64_t checkpoint_step(const std::string& path);

/// Collective. Writes every field with checkpoint = true of the owned particles and the named state (the root's). The
/// file appears under its name only when it is complete and on the disk. Throws Error(Io) on all ranks otherwise, and
/// then leaves neither a file of that name nor a temporary one.
void write_checkpoint(const Comm& comm, const std::string& path, const ParticleSet& particles, const NamedState& state);

/// Collective. Fills `particles`, whose fields must have been added before, and returns the named state. On as many
/// ranks as wrote the file, every rank gets its particles in the order in which it wrote them; on another number, an
/// even share that the caller redistributes. Throws Error(Io) on all ranks if the file is damaged, incomplete or of
/// another space, if a field of the set is not in the file, or if a field of the file is neither in the set nor listed
/// in `ignored`.
NamedState read_checkpoint(const Comm& comm, const std::string& path, ParticleSet& particles,
                           const std::vector<std::string>& ignored = {});

/// Collective. The complete checkpoint of the highest step in the folder whose contents match their checksums; damaged
/// ones are passed over with a warning in the log. Empty if there is none.
std::string find_newest_checkpoint(const Comm& comm, const std::string& folder);

/// Collective. Deletes all checkpoints but the `keep` complete ones of the highest steps, and temporary files left by a
/// run that was killed.
void keep_newest_checkpoints(const Comm& comm, const std::string& folder, int keep = 2);

/// Collective. For a restart that goes back before the newest checkpoint: renames those of later steps to
/// NAME.set_aside, so that they are neither taken for the newest nor push out the new ones.
void set_aside_checkpoints_after(const Comm& comm, const std::string& folder, std::int64_t step);

}  // namespace stirsph
