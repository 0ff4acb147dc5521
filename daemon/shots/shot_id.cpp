#include "daemon/shots/shot_id.hpp"

#include <fmt/format.h>

#include <cstdio>
#include <ctime>

namespace kolsky {

std::string format_utc_compact(std::int64_t utc_ns) {
  constexpr std::int64_t kSecond_ns = 1'000'000'000;
  std::int64_t seconds = utc_ns / kSecond_ns;
  std::int64_t rest_ns = utc_ns % kSecond_ns;
  if (rest_ns < 0) {
    rest_ns += kSecond_ns;
    --seconds;
  }
  const std::time_t time = seconds;
  std::tm utc{};
  gmtime_r(&time, &utc);
  return fmt::format("{:04}{:02}{:02}T{:02}{:02}{:02}{:03}Z", utc.tm_year + 1900, utc.tm_mon + 1,
                     utc.tm_mday, utc.tm_hour, utc.tm_min, utc.tm_sec, rest_ns / 1'000'000);
}

std::optional<std::int64_t> utc_of_shot_id(const std::string& id) {
  std::tm utc{};
  int milliseconds = 0;
  if (std::sscanf(id.c_str(), "%4d%2d%2dT%2d%2d%2d%3dZ", &utc.tm_year, &utc.tm_mon, &utc.tm_mday,
                  &utc.tm_hour, &utc.tm_min, &utc.tm_sec, &milliseconds) != 7) {
    return std::nullopt;
  }
  utc.tm_year -= 1900;
  utc.tm_mon -= 1;
  const std::int64_t utc_ns =
      (std::int64_t{timegm(&utc)} * 1000 + milliseconds) * std::int64_t{1'000'000};
  // What is no date came back as another.
  return id.starts_with(format_utc_compact(utc_ns)) ? std::optional(utc_ns) : std::nullopt;
}

ShotIdSource::ShotIdSource(std::uint64_t boot_id) : boot_id_(boot_id) {}

std::string ShotIdSource::next(std::int64_t utc_ns) {
  ++count_;
  return fmt::format("{}-{:04x}-{:04}", format_utc_compact(utc_ns), boot_id_ & 0xffff, count_);
}

}  // namespace kolsky
