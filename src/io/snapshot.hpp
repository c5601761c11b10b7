/// Particle fields and meshed rigid bodies for ParaView and Python: VTKHDF files and an index of their times.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "base/comm.hpp"
#include "io/rigid_snapshot.hpp"
#include "particles/particle_set.hpp"

namespace stirsph {

/// A scalar computed for the snapshot only (von Mises stress, pressure); one value per owned particle.
struct DerivedField {
  std::string name, unit, meaning;
  std::vector<double> values;
};

/// The numbered snapshots of a run folder: snapshot_000012.vtkhdf with the particles and, in scenes with meshed rigid
/// bodies, rigid_000012.vtkhdf with these; `snapshots.csv` (number, step, time, file, rigid file); and
/// `snapshots.vtkhdf.series` and `rigid.vtkhdf.series`, with which ParaView shows each as one animation with true
/// times. Particles are vertex cells of one unstructured grid. Values are single precision, whole numbers (ids, bodies,
/// materials) 64-bit integers, symmetric tensors in VTK's order xx yy zz xy yz xz.
class SnapshotSeries {
 public:
  /// `fields` names the fields to write, empty for those declared with snapshot = true; `also` (if not empty) one more.
  /// The position is always written.
  SnapshotSeries(const Comm& comm, const std::string& folder, const std::vector<std::string>& fields = {},
                 std::string_view also = {});

  /// Collective. After a restart at `time` [s]: continues the numbering behind the snapshots up to that time and
  /// forgets later ones, which will be overwritten. `time_tolerance` [s] should be a fraction of a time step.
  void resume(double time, double time_tolerance);

  /// Collective. Writes the next snapshot and returns the path of its particles. A file appears under its name only
  /// when complete. `rigid`: as many meshed bodies on every rank, none for a snapshot of particles only.
  std::string write(const ParticleSet& particles, double time, std::int64_t step,
                    const std::vector<DerivedField>& derived = {}, const std::vector<MeshState>& rigid = {});

  /// Number of the next snapshot.
  int next() const { return static_cast<int>(entries_.size()); }

 private:
  struct Entry {
    std::int64_t step;
    double time;
    bool rigid;  ///< it has meshed bodies too
  };

  void check_names(const ParticleSet& particles, const std::vector<DerivedField>& derived) const;
  bool selected(const FieldInfo& info) const;
  void write_index() const;

  Comm comm_;
  std::string folder_;
  std::vector<std::string> fields_;
  std::string also_;
  std::vector<Entry> entries_;
};

/// FOLDER/snapshot_000012.vtkhdf
std::string snapshot_path(const std::string& folder, int number);

}  // namespace stirsph
