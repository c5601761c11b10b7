/// Turning PETSc's return codes into exceptions.
#pragma once

#include <string>

namespace stirsph {

/// Throws Error(Internal) with PETSc's own text when `status` (a PetscErrorCode) is not zero.
void check_petsc(int status, const char* call);
/// What PETSc says about the error it returned last.
std::string petsc_message(int status);

}  // namespace stirsph

/// Wraps a PETSc call so that no return code goes unseen.
#define STIRSPH_PETSC(call) ::stirsph::check_petsc(static_cast<int>(call), #call)
