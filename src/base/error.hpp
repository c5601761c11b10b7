/// The errors a user can meet, and the exit code of the program for each.
#pragma once

#include <stdexcept>
#include <string>

namespace stirsph {

/// Exit codes of the programs; listed in the README so that job scripts can tell the cases apart.
enum class ExitCode : int {
  Finished = 0,
  Internal = 1,  ///< a bug or an unforeseen system failure
  Input = 2,     ///< the scene, the command line or a file named by them is wrong
  BlowUp = 3,    ///< the computation lost its footing: NaN, lost particle, runaway penetration
  Solver = 4,    ///< a linear solve did not converge
  Io = 5,        ///< a result or checkpoint could not be written or read
  Stopped = 10,  ///< stopped before the end on purpose (wall-clock limit, signal, stop file); restartable
};

/// An error with an exit code. The message says what is wrong, where, what is allowed and what to do.
class Error : public std::runtime_error {
 public:
  Error(ExitCode code, const std::string& message) : std::runtime_error(message), code_(code) {}
  ExitCode code() const { return code_; }

 private:
  ExitCode code_;
};

struct InputError : Error {
  explicit InputError(const std::string& message) : Error(ExitCode::Input, message) {}
};
struct BlowUp : Error {
  explicit BlowUp(const std::string& message) : Error(ExitCode::BlowUp, message) {}
};
struct SolverError : Error {
  explicit SolverError(const std::string& message) : Error(ExitCode::Solver, message) {}
};
struct IoError : Error {
  explicit IoError(const std::string& message) : Error(ExitCode::Io, message) {}
};

/// Thrown by STIRSPH_EXPECT: a promise inside the code was broken (a bug, not a user error).
[[noreturn]] void contract_violation(const char* condition, const char* file, int line, const std::string& message);

}  // namespace stirsph

/// A contract checked in Debug builds (STIRSPH_CONTRACTS); in release builds it costs nothing.
#ifdef STIRSPH_CONTRACTS
#define STIRSPH_EXPECT(condition, message) \
  ((condition) ? void(0) : ::stirsph::contract_violation(#condition, __FILE__, __LINE__, message))
#else
#define STIRSPH_EXPECT(condition, message) void(0)
#endif
