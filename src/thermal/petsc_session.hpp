/// PETSc's lifetime: initialised once after MPI, finalised before MPI.
#pragma once

#include <string>

namespace stirsph {

class PetscSession {
 public:
  /// `options` is a PETSc options string ("-heat_pc_type jacobi ..."); empty for none. PETSc's own signal handlers are
  /// left off.
  explicit PetscSession(const std::string& options = {});
  ~PetscSession();
  PetscSession(const PetscSession&) = delete;
  PetscSession& operator=(const PetscSession&) = delete;
};

}  // namespace stirsph
