#include "driver/step_vote.hpp"

#include <algorithm>
#include <limits>

namespace stirsph {
namespace {

/// The reduction sees whole ballots: the first slots are maxima, the rest sums.
void combine(void* in, void* inout, int* count, MPI_Datatype* type) {
  int bytes = 0;
  MPI_Type_size(*type, &bytes);
  const std::size_t width = static_cast<std::size_t>(bytes) / sizeof(double);
  const double* from = static_cast<const double*>(in);
  double* to = static_cast<double*>(inout);
  for (int ballot = 0; ballot < *count; ++ballot, from += width, to += width)
    for (std::size_t k = 0; k < width; ++k) to[k] = k < StepVote::slots ? std::max(from[k], to[k]) : from[k] + to[k];
}

}  // namespace

StepVote::StepVote(Comm comm, std::size_t sums) : comm_(comm), values_(slots + sums) {
  check_mpi(MPI_Type_contiguous(static_cast<int>(values_.size()), MPI_DOUBLE, &type_), "MPI_Type_contiguous");
  check_mpi(MPI_Type_commit(&type_), "MPI_Type_commit");
  check_mpi(MPI_Op_create(&combine, 0, &operation_), "MPI_Op_create");
  clear();
}

StepVote::~StepVote() {
  MPI_Op_free(&operation_);
  MPI_Type_free(&type_);
}

void StepVote::clear() {
  std::fill(values_.begin(), values_.end(), 0.0);
  values_[NegativeLength] = -std::numeric_limits<double>::infinity();
}

void StepVote::take() {
  check_mpi(MPI_Allreduce(MPI_IN_PLACE, values_.data(), 1, type_, operation_, comm_.handle()), "MPI_Allreduce");
}

}  // namespace stirsph
