/// Paths of chosen particles: FOLDER/tracer_NAME.csv, one row per particle and record.
#pragma once

#include <string>
#include <vector>

#include "driver/schedule.hpp"
#include "driver/simulation.hpp"
#include "io/history.hpp"

namespace stirsph {

/// One [[tracer]] of a scene. The file has the columns time, id, x, y, z (scene's frame) and the fields asked for; the
/// rows of a record are in the order of the ids on any number of ranks.
class Tracer {
 public:
  Tracer(const TracerScene& scene, std::string folder);

  /// Begins the file with a record of the present state; or continues that of an earlier run, of which records after
  /// the present time are dropped: they will come again. Collective. Throws IoError on all ranks.
  void begin(const Simulation& simulation);
  void resume(const Simulation& simulation);
  /// Writes a record if one is due after the step just made. Collective.
  void after_step(const Simulation& simulation);

 private:
  void record(const Simulation& simulation);
  std::vector<std::string> fields_of(const Simulation& simulation) const;
  std::vector<HistoryColumn> columns(const Simulation& simulation) const;

  TracerScene scene_;
  std::string path_;
  Schedule schedule_;
  History file_;
};

}  // namespace stirsph
