#include "thermal/linear_solve.hpp"

#include <fmt/format.h>
#include <petscksp.h>

#include <type_traits>
#include <vector>

#include "base/error.hpp"
#include "thermal/petsc_check.hpp"

namespace stirsph {
namespace {

/// PETSc may be built with 64-bit indices; then it needs its own copy of ours.
class Indices {
 public:
  PetscInt* from(std::vector<int>& values) {
    if constexpr (std::is_same_v<PetscInt, int>) {
      return values.data();
    } else {
      copy_.assign(values.begin(), values.end());
      return copy_.data();
    }
  }
  PetscInt* copy_of(const std::vector<int>& values) {
    copy_.assign(values.begin(), values.end());
    return copy_.data();
  }

 private:
  std::vector<PetscInt> copy_;
};

const char* advice(KSPConvergedReason reason) {
  switch (reason) {
    case KSP_DIVERGED_ITS:
      return "raise -heat_ksp_max_it, take a stronger preconditioner (-heat_pc_type bjacobi -heat_sub_pc_type icc, or "
             "gamg) or a shorter heat step";
    case KSP_DIVERGED_NANORINF:
      return "a temperature, conductivity, volume or heat source is not a finite number: look at the last snapshot and "
             "at the time step";
    case KSP_DIVERGED_INDEFINITE_PC:
    case KSP_DIVERGED_INDEFINITE_MAT:
      return "the matrix is not positive definite: check that density, specific heat and conductivity are positive "
             "over "
             "the temperatures of the run";
    default:
      return "run with -heat_ksp_monitor_true_residual -heat_ksp_view to see why, and change -heat_ksp_type or "
             "-heat_pc_type";
  }
}

}  // namespace

struct LinearSolve::Impl {
  Impl(const Comm& c, const Settings& s) : comm(c), settings(s) {}

  Comm comm;
  Settings settings;
  KSP ksp = nullptr;
  Mat matrix = nullptr, own = nullptr, far = nullptr;
  Vec right = nullptr, solution = nullptr, rest = nullptr;  // frames around the caller's arrays
  Indices own_starts, own_columns, far_starts, far_columns;
};

LinearSolve::LinearSolve(const Comm& comm, Settings settings) : impl_(std::make_unique<Impl>(comm, settings)) {
  KSP& ksp = impl_->ksp;
  STIRSPH_PETSC(KSPCreate(comm.handle(), &ksp));
  STIRSPH_PETSC(KSPSetOptionsPrefix(ksp, "heat_"));
  STIRSPH_PETSC(KSPSetType(ksp, KSPCG));
  PC pc = nullptr;
  STIRSPH_PETSC(KSPGetPC(ksp, &pc));
  STIRSPH_PETSC(PCSetType(pc, PCJACOBI));
  // The true residual is heat [J] that would go missing: the tolerance then bounds the heat balance whatever the
  // preconditioner, also with a body in the system whose heat capacity is a million times that of a particle.
  STIRSPH_PETSC(KSPSetNormType(ksp, KSP_NORM_UNPRECONDITIONED));
  STIRSPH_PETSC(KSPSetTolerances(ksp, settings.relative_tolerance, 1e-50, 1e6, settings.maximum_iterations));
  STIRSPH_PETSC(KSPSetInitialGuessNonzero(ksp, PETSC_TRUE));
  if (const int status = KSPSetFromOptions(ksp))
    throw InputError("PETSc refuses its options: " + petsc_message(status) +
                     ". Correct --petsc, PETSC_OPTIONS or .petscrc");
}

LinearSolve::~LinearSolve() {
  PetscBool finalized = PETSC_FALSE;
  PetscFinalized(&finalized);
  if (finalized) return;  // PETSc has taken its objects with it
  VecDestroy(&impl_->right);
  VecDestroy(&impl_->solution);
  VecDestroy(&impl_->rest);
  MatDestroy(&impl_->matrix);
  KSPDestroy(&impl_->ksp);
}

void LinearSolve::release_matrix() {
  Impl& m = *impl_;
  if (!m.matrix) return;
  STIRSPH_PETSC(KSPReset(m.ksp));
  for (Vec* vector : {&m.right, &m.solution, &m.rest}) STIRSPH_PETSC(VecDestroy(vector));
  STIRSPH_PETSC(MatDestroy(&m.matrix));
}

void LinearSolve::use_matrix(HeatMatrix& matrix) {
  Impl& m = *impl_;
  if (m.matrix) {
    // The values were written behind PETSc's back; taking and returning the arrays, and an assembly with nothing to
    // send, give the blocks and the matrix a new state, by which the preconditioner knows that it is out of date.
    for (Mat block : {m.own, m.far}) {
      PetscScalar* values = nullptr;
      STIRSPH_PETSC(MatSeqAIJGetArray(block, &values));
      STIRSPH_PETSC(MatSeqAIJRestoreArray(block, &values));
    }
    STIRSPH_PETSC(MatAssemblyBegin(m.matrix, MAT_FINAL_ASSEMBLY));
    STIRSPH_PETSC(MatAssemblyEnd(m.matrix, MAT_FINAL_ASSEMBLY));
    // PETSc 3.18 cannot renew the coarse levels of GAMG when their sizes change with the values.
    PC pc = nullptr;
    PetscBool multigrid = PETSC_FALSE;
    STIRSPH_PETSC(KSPGetPC(m.ksp, &pc));
    STIRSPH_PETSC(PetscObjectTypeCompare(reinterpret_cast<PetscObject>(pc), PCGAMG, &multigrid));
    if (multigrid) {
      STIRSPH_PETSC(KSPReset(m.ksp));
      STIRSPH_PETSC(KSPSetOperators(m.ksp, m.matrix, m.matrix));
    }
    return;
  }
  const auto rows = static_cast<PetscInt>(matrix.rows());
  // PETSc renumbers the far columns in place, so it gets a copy of them; the large own block is shared.
  STIRSPH_PETSC(MatCreateMPIAIJWithSplitArrays(
      m.comm.handle(), rows, rows, PETSC_DETERMINE, PETSC_DETERMINE, m.own_starts.from(matrix.own.starts),
      m.own_columns.from(matrix.own.columns), matrix.own.values.data(), m.far_starts.from(matrix.far.starts),
      m.far_columns.copy_of(matrix.far.columns), matrix.far.values.data(), &m.matrix));
  STIRSPH_PETSC(MatMPIAIJGetSeqAIJ(m.matrix, &m.own, &m.far, nullptr));
  STIRSPH_PETSC(MatSetOption(m.matrix, MAT_SPD, PETSC_TRUE));
  for (Vec* vector : {&m.right, &m.solution, &m.rest})
    STIRSPH_PETSC(VecCreateMPIWithArray(m.comm.handle(), 1, rows, PETSC_DETERMINE, nullptr, vector));
  STIRSPH_PETSC(KSPSetOperators(m.ksp, m.matrix, m.matrix));
}

LinearSolve::Outcome LinearSolve::solve(std::span<const double> b, std::span<double> x) {
  Impl& m = *impl_;
  STIRSPH_PETSC(VecPlaceArray(m.right, b.data()));
  STIRSPH_PETSC(VecPlaceArray(m.solution, x.data()));
  PetscReal norm = 0, residual = 0;
  STIRSPH_PETSC(VecNorm(m.right, NORM_2, &norm));
  STIRSPH_PETSC(KSPSolve(m.ksp, m.right, m.solution));
  STIRSPH_PETSC(VecResetArray(m.right));
  STIRSPH_PETSC(VecResetArray(m.solution));

  KSPConvergedReason reason = KSP_CONVERGED_ITERATING;
  PetscInt iterations = 0;
  STIRSPH_PETSC(KSPGetConvergedReason(m.ksp, &reason));
  STIRSPH_PETSC(KSPGetIterationNumber(m.ksp, &iterations));
  STIRSPH_PETSC(KSPGetResidualNorm(m.ksp, &residual));
  const double relative = norm > 0 ? residual / norm : residual;
  if (reason < 0)  // the reason is the same on all ranks, so all of them throw
    throw SolverError(
        fmt::format("the heat equation was not solved: {} after {} iterations, relative residual {:.3g} (wanted "
                    "{:.3g}). What to do: {}",
                    KSPConvergedReasons[reason], iterations, relative, m.settings.relative_tolerance, advice(reason)));
  return {static_cast<int>(iterations), relative};
}

void LinearSolve::residual(std::span<const double> b, std::span<const double> x, std::span<double> r) {
  Impl& m = *impl_;
  STIRSPH_PETSC(VecPlaceArray(m.right, b.data()));
  STIRSPH_PETSC(VecPlaceArray(m.solution, x.data()));
  STIRSPH_PETSC(VecPlaceArray(m.rest, r.data()));
  STIRSPH_PETSC(MatResidual(m.matrix, m.right, m.solution, m.rest));
  for (Vec vector : {m.right, m.solution, m.rest}) STIRSPH_PETSC(VecResetArray(vector));
}

}  // namespace stirsph
