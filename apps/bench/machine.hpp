/// What one core can do at most: the ceiling that the speed of the pair sweeps is held against.
#pragma once

#include <string>

#include "base/comm.hpp"

namespace stirsph::bench {

/// The processor as the system names it; "unknown" where /proc/cpuinfo does not say.
struct Processor {
  std::string model, family, model_number;
};
Processor processor();

/// Rates of one core in the registers this program was built for, mean over ranks that all work at the same time.
struct MachineRates {
  double multiply_add = 0;  ///< flop/s of fused multiply-adds, two each
  double add = 0;           ///< additions per second; lanes counted
  double divide = 0;        ///< divisions per second; lanes counted
  double square_root = 0;   ///< square roots per second; lanes counted
  double triad = 0;         ///< byte/s of a = b + s c in arrays far larger than the caches; 24 bytes per element
};

/// Best of five runs of about 0.1 s each. Collective.
MachineRates measure_machine(const Comm& comm);

}  // namespace stirsph::bench
