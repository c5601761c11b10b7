#include "thermal/petsc_session.hpp"

#include <petscsys.h>

#include "base/error.hpp"
#include "base/log.hpp"
#include "thermal/petsc_check.hpp"

namespace stirsph {

namespace {

std::string last_message;  ///< of PETSc, about the error it returned last

/// PETSc's own handler prints a trace, waits 10 s on all ranks but the first and aborts; here an error becomes an
/// exception with PETSc's message.
PetscErrorCode remember_error(MPI_Comm, int, const char*, const char*, PetscErrorCode status, PetscErrorType type,
                              const char* message, void*) {
  if (type == PETSC_ERROR_INITIAL) last_message = message ? message : "";
  return status;
}

/// PETSc takes any option; one that nothing asked for is probably misspelt.
void warn_of_unused_options() {
  PetscInt count = 0;
  char **names = nullptr, **values = nullptr;
  if (PetscOptionsLeftGet(nullptr, &count, &names, &values) != 0) return;
  for (PetscInt k = 0; k < count; ++k)
    log::warning(std::string("the PETSc option -") + names[k] +
                 " was not used: misspelt, or nothing in this scene needs it");
  static_cast<void>(PetscOptionsLeftRestore(nullptr, &count, &names, &values));
}

}  // namespace

std::string petsc_message(int status) {
  const char* text = nullptr;
  PetscErrorMessage(static_cast<PetscErrorCode>(status), &text, nullptr);
  std::string message = text ? text : "code " + std::to_string(status);
  if (!last_message.empty()) message = last_message + " (" + message + ")";
  while (!message.empty() && message.back() == '\n') message.pop_back();
  return message;
}

void check_petsc(int status, const char* call) {
  if (status != 0) throw Error(ExitCode::Internal, std::string("PETSc: ") + call + " failed: " + petsc_message(status));
}

PetscSession::PetscSession(const std::string& options) {
  // The program handles its own signals (it stops at a step's end and writes a checkpoint) and has its own command
  // line; PETSc reads its options from this string, from PETSC_OPTIONS and from the usual .petscrc files.
  STIRSPH_PETSC(PetscOptionsSetValue(nullptr, "-no_signal_handler", "true"));
  STIRSPH_PETSC(PetscInitializeNoArguments());
  STIRSPH_PETSC(PetscPushErrorHandler(remember_error, nullptr));
  if (!options.empty()) STIRSPH_PETSC(PetscOptionsInsertString(nullptr, options.c_str()));
}

PetscSession::~PetscSession() {
  PetscBool finalized = PETSC_FALSE;
  PetscFinalized(&finalized);
  if (finalized) return;
  warn_of_unused_options();
  // A destructor cannot report; PETSc has printed the cause.
  static_cast<void>(PetscFinalize());
}

}  // namespace stirsph
