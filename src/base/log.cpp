#include "base/log.hpp"

#include <spdlog/sinks/basic_file_sink.h>
#include <spdlog/sinks/stdout_sinks.h>
#include <spdlog/spdlog.h>

#include <memory>
#include <vector>

#include "base/error.hpp"

namespace stirsph::log {
namespace {
std::shared_ptr<spdlog::logger> logger;
}

void open(int rank, const std::string& file, bool append, bool quiet_console) {
  if (rank != 0) {
    logger.reset();
    return;
  }
  std::vector<spdlog::sink_ptr> sinks;
  if (!quiet_console) sinks.push_back(std::make_shared<spdlog::sinks::stdout_sink_st>());
  try {
    if (!file.empty()) sinks.push_back(std::make_shared<spdlog::sinks::basic_file_sink_st>(file, !append));
  } catch (const spdlog::spdlog_ex& failure) {
    throw IoError("cannot write the log file " + file + ": " + failure.what());
  }
  logger = std::make_shared<spdlog::logger>("stirsph", sinks.begin(), sinks.end());
  logger->set_pattern("%v");
  logger->flush_on(spdlog::level::info);
}

void info(const std::string& message) {
  if (logger) logger->info(message);
}
void warning(const std::string& message) {
  if (logger) logger->warn("warning: " + message);
}
void error(const std::string& message) {
  if (logger) logger->error("error: " + message);
}
void flush() {
  if (logger) logger->flush();
}

}  // namespace stirsph::log
