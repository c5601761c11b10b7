/// Turning PETSc's return codes into exceptions.
#pragma once

namespace stirsph {

/// Throws Error(Internal) with PETSc's own text when `status` (a PetscErrorCode) is not zero.
void check_petsc(int status, const char* call);

}  // namespace stirsph

/// Wraps a PETSc call so that no return code goes unseen.
#define STIRSPH_PETSC(call) ::stirsph::check_petsc(static_cast<int>(call), #call)
