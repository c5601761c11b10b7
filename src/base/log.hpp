/// Log lines of the run: rank 0 writes to the console and to a file, the other ranks keep silent unless they fail.
#pragma once

#include <string>

namespace stirsph::log {

/// Must be called once on every rank; before that, messages are dropped. `file` may be empty (console only).
/// `append` continues the file of an earlier run (restart).
void open(int rank, const std::string& file, bool append, bool quiet_console = false);
void info(const std::string& message);
void warning(const std::string& message);
void error(const std::string& message);
void flush();

}  // namespace stirsph::log
