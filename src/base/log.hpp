/// Log lines of the run: rank 0 writes to the console and to a file, the other ranks keep silent.
#pragma once

#include <string>

namespace stirsph::log {

/// Must be called on rank 0 before the run; without it information and warnings are dropped. `file` may be empty
/// (console only). `append` continues the file of an earlier run (restart).
void open(int rank, const std::string& file, bool append, bool quiet_console = false);
void info(const std::string& message);
void warning(const std::string& message);
/// To standard error, quiet console or not, and to the log file if there is one already. Call it on one rank only.
void error(const std::string& message);
void flush();

}  // namespace stirsph::log
