#pragma once

#include <cstdint>
#include <string>

namespace kolsky::cli {

/// ISO 8601, UTC, microseconds: "2026-02-03T10:20:30.123456Z".
[[nodiscard]] std::string iso_time(std::int64_t utc_ns);

/// For lists: "2026-02-03 10:20:30".
[[nodiscard]] std::string short_time(std::int64_t utc_ns);

}  // namespace kolsky::cli
