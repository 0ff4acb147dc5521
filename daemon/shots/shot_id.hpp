#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace kolsky {

/// Names shots: UTC date and time of the trigger, four digits of the boot id and a counter, as
/// "20250117T101530123Z-1f3a-0001". Sorts by time, is a file name, and two runs never share one
/// even where the clock was set back.
class ShotIdSource {
 public:
  explicit ShotIdSource(std::uint64_t boot_id);
  [[nodiscard]] std::string next(std::int64_t utc_ns);

 private:
  std::uint64_t boot_id_;
  std::uint64_t count_ = 0;
};

/// The time in a shot's id, to the millisecond; nothing where it is none of ours.
[[nodiscard]] std::optional<std::int64_t> utc_of_shot_id(const std::string& id);

/// "20250117T101530123Z"
[[nodiscard]] std::string format_utc_compact(std::int64_t utc_ns);

}  // namespace kolsky
