/// The one small allreduce of a step: what the ranks must agree on before the next step, maxima and sums in one
/// message.
#pragma once

#include <cstddef>
#include <vector>

#include "base/comm.hpp"

namespace stirsph {

class StepVote {
 public:
  /// `sums`: how many summed values (forces and torques of the rigid bodies).
  StepVote(Comm comm, std::size_t sums);
  ~StepVote();
  StepVote(const StepVote&) = delete;
  StepVote& operator=(const StepVote&) = delete;

  // this rank's ballot, replaced by the result of the vote (maxima)
  enum Slot {
    Failure,
    Stop,
    WriteProgress,
    WriteCheckpoint,
    Deviation,
    RelativeSpeed,
    Displacement,
    Speed,
    Acceleration,
    Penetration,
    NegativeLength,
    slots
  };
  double& operator[](Slot slot) { return values_[slot]; }
  double& sum(std::size_t k) { return values_[slots + k]; }
  /// Clears the ballot for the next step.
  void clear();
  /// Collective: combines all ballots. The sum runs in rank order of a fixed tree, so it repeats at equal rank count.
  void take();

 private:
  Comm comm_;
  std::vector<double> values_;
  MPI_Datatype type_ = MPI_DATATYPE_NULL;
  MPI_Op operation_ = MPI_OP_NULL;
};

}  // namespace stirsph
