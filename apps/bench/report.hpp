/// What stirsph_bench says: lines for people, one JSON record for programs.
#pragma once

#include <string>

#include "bench/machine.hpp"
#include "bench/measure.hpp"

namespace stirsph::bench {

/// How the measurement was asked for.
struct Options {
  std::string scene;
  std::int64_t particles = 0;       ///< 0: the scene's own number
  std::string gradient_correction;  ///< none, velocity or full, as used
  int repeats = 1;
};

/// Several lines; the last holds the figures as key=value.
std::string text_report(const Options& options, const Measurement& measurement);
/// One object: machine, compiler, commit, scene, options, figures, rates of all repeats, phases of the median repeat
/// in seconds.
std::string json_report(const Options& options, const Measurement& measurement);

std::string text_report(const MachineRates& rates, int ranks);
std::string json_report(const MachineRates& rates, int ranks);

/// The scene without running it: particles, spacing.
std::string json_report(const Options& options, std::int64_t particles, double spacing, int ranks);

}  // namespace stirsph::bench
