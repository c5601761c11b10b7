#include "base/error.hpp"

namespace stirsph {

void contract_violation(const char* condition, const char* file, int line, const std::string& message) {
  throw Error(ExitCode::Internal, std::string(file) + ":" + std::to_string(line) + ": contract broken: " + condition +
                                      " (" + message + ")");
}

}  // namespace stirsph
