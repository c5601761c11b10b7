#include "thermal/petsc_session.hpp"

#include <petscsys.h>

#include "base/error.hpp"
#include "thermal/petsc_check.hpp"

namespace stirsph {

void check_petsc(int status, const char* call) {
  if (status == 0) return;
  const char* text = nullptr;
  PetscErrorMessage(static_cast<PetscErrorCode>(status), &text, nullptr);
  throw Error(ExitCode::Internal,
              std::string("PETSc: ") + call + " failed: " + (text ? text : "code " + std::to_string(status)));
}

PetscSession::PetscSession(const std::string& options) {
  // The program handles its own signals (it stops at a step's end and writes a checkpoint) and has its own command
  // line; PETSc reads its options from this string, from PETSC_OPTIONS and from the usual .petscrc files.
  STIRSPH_PETSC(PetscOptionsSetValue(nullptr, "-no_signal_handler", "true"));
  STIRSPH_PETSC(PetscInitializeNoArguments());
  if (!options.empty()) STIRSPH_PETSC(PetscOptionsInsertString(nullptr, options.c_str()));
}

PetscSession::~PetscSession() {
  PetscBool finalized = PETSC_FALSE;
  PetscFinalized(&finalized);
  // A destructor cannot report; PETSc has printed the cause.
  if (!finalized) static_cast<void>(PetscFinalize());
}

}  // namespace stirsph
