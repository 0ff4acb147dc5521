#include "clients/cli/reports/time_text.hpp"

#include <fmt/format.h>

#include <ctime>

namespace kolsky::cli {
namespace {

constexpr std::int64_t kSecond_ns = 1'000'000'000;

struct UtcTime {
  std::tm fields{};
  std::int64_t fraction_ns = 0;
};

UtcTime utc_time(std::int64_t utc_ns) {
  std::int64_t fraction_ns = utc_ns % kSecond_ns;
  fraction_ns += fraction_ns < 0 ? kSecond_ns : 0;
  const std::time_t seconds = (utc_ns - fraction_ns) / kSecond_ns;
  UtcTime time;
  time.fraction_ns = fraction_ns;
  gmtime_r(&seconds, &time.fields);
  return time;
}

std::string date_and_time(const std::tm& fields, char between) {
  return fmt::format("{:04}-{:02}-{:02}{}{:02}:{:02}:{:02}", fields.tm_year + 1900,
                     fields.tm_mon + 1, fields.tm_mday, between, fields.tm_hour, fields.tm_min,
                     fields.tm_sec);
}

}  // namespace

std::string iso_time(std::int64_t utc_ns) {
  const UtcTime time = utc_time(utc_ns);
  return fmt::format("{}.{:06}Z", date_and_time(time.fields, 'T'), time.fraction_ns / 1000);
}

std::string short_time(std::int64_t utc_ns) {
  return date_and_time(utc_time(utc_ns).fields, ' ');
}

}  // namespace kolsky::cli
