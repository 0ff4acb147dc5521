#include "daemon/log.hpp"

#include <spdlog/async.h>
#include <spdlog/sinks/stdout_sinks.h>
#include <spdlog/spdlog.h>

namespace kolsky::log {

namespace {

constexpr std::size_t kLines = 8192;
constexpr const char* kName = "kolskyd";

spdlog::level::level_enum threshold(Level level) {
  switch (level) {
    case Level::quiet:
      return spdlog::level::warn;
    case Level::normal:
      return spdlog::level::info;
    case Level::verbose:
      break;
  }
  return spdlog::level::debug;
}

}  // namespace

void start(Level level) {
  spdlog::drop(kName);
  spdlog::init_thread_pool(kLines, 1);
  auto logger = spdlog::create_async_nb<spdlog::sinks::stderr_sink_mt>(kName);
  logger->set_pattern("%Y-%m-%dT%H:%M:%S.%eZ %l %v", spdlog::pattern_time_type::utc);
  logger->set_level(threshold(level));
  logger->flush_on(spdlog::level::info);
  spdlog::set_default_logger(std::move(logger));
}

void stop() {
  auto direct = std::make_shared<spdlog::logger>("kolskyd-direct",
                                                 std::make_shared<spdlog::sinks::stderr_sink_mt>());
  direct->set_level(spdlog::default_logger_raw()->level());
  spdlog::set_default_logger(std::move(direct));
  spdlog::drop(kName);
  // The pool writes what it still holds before it ends.
  spdlog::details::registry::instance().set_tp(nullptr);
}

void debug(const std::string& line) {
  spdlog::debug("{}", line);
}
void info(const std::string& line) {
  spdlog::info("{}", line);
}
void warning(const std::string& line) {
  spdlog::warn("{}", line);
}
void error(const std::string& line) {
  spdlog::error("{}", line);
}

}  // namespace kolsky::log
