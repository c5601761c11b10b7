#include "base/log.hpp"

#include <spdlog/sinks/basic_file_sink.h>
#include <spdlog/sinks/stdout_sinks.h>
#include <spdlog/spdlog.h>

#include <iostream>
#include <memory>
#include <utility>
#include <vector>

#include "base/error.hpp"

namespace stirsph::log {
namespace {

std::shared_ptr<spdlog::logger> logger, errors;

std::shared_ptr<spdlog::logger> make_logger(const std::vector<spdlog::sink_ptr>& sinks) {
  auto result = std::make_shared<spdlog::logger>("stirsph", sinks.begin(), sinks.end());
  result->set_pattern("%v");
  result->flush_on(spdlog::level::info);
  // A full disk shows in every line that cannot be written: saying so once is enough.
  result->set_error_handler([](const std::string& failure) {
    static bool told = false;
    if (!std::exchange(told, true)) std::cerr << "the log file cannot be written: " << failure << std::endl;
  });
  return result;
}

}  // namespace

void open(int rank, const std::string& file, bool append, bool quiet_console) {
  logger.reset();
  errors.reset();
  if (rank != 0) return;
  std::vector<spdlog::sink_ptr> ordinary, erroneous{std::make_shared<spdlog::sinks::stderr_sink_st>()};
  if (!quiet_console) ordinary.push_back(std::make_shared<spdlog::sinks::stdout_sink_st>());
  if (!file.empty()) {
    try {
      ordinary.push_back(std::make_shared<spdlog::sinks::basic_file_sink_st>(file, !append));
    } catch (const spdlog::spdlog_ex& failure) {
      throw IoError("cannot write the log file " + file + ": " + failure.what());
    }
    erroneous.push_back(ordinary.back());
  }
  logger = make_logger(ordinary);
  errors = make_logger(erroneous);
}

void info(const std::string& message) {
  if (logger) logger->info(message);
}
void warning(const std::string& message) {
  if (logger) logger->warn("warning: " + message);
}
void error(const std::string& message) {
  if (errors)
    errors->error("error: " + message);
  else
    std::cerr << "error: " << message << std::endl;
}
void flush() {
  if (logger) logger->flush();
}

}  // namespace stirsph::log
