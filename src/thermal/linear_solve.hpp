/// The PETSc side of a heat solve: matrix around existing arrays, KSP with options prefix `heat_`.
#pragma once

#include <memory>
#include <span>

#include "base/comm.hpp"
#include "thermal/heat_matrix.hpp"

namespace stirsph {

class LinearSolve {
 public:
  struct Settings {
    double relative_tolerance = 1e-8;
    int maximum_iterations = 1000;
  };
  struct Outcome {
    int iterations = 0;
    double residual = 0;  ///< relative to the right side
  };

  LinearSolve(const Comm& comm, Settings settings);
  ~LinearSolve();

  /// Gives up the matrix, so that its arrays may change their shape. Collective.
  void release_matrix();
  /// Uses the arrays of `matrix`, which must stay where they are until release_matrix. Call it again, with the same
  /// arrays, after their values have changed. Collective.
  void use_matrix(HeatMatrix& matrix);

  /// Solves A x = b starting from x. Throws SolverError on all ranks when the KSP does not converge. Collective.
  Outcome solve(std::span<const double> b, std::span<double> x);
  /// r = b - A x. Collective.
  void residual(std::span<const double> b, std::span<const double> x, std::span<double> r);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace stirsph
