#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "processing/base/shot.hpp"

namespace kolsky {

/// One question asked before arming, and its answer for people.
struct PreflightItem {
  std::string name;
  bool ok = false;
  std::string text;
};

/// What is known about one channel when arming is asked for.
struct ChannelCondition {
  double baseline_codes = 0.0;
  double noise_codes = 0.0;
  std::int64_t constant_samples = 0;  ///< for how long the code has not changed
  bool learned = false;               ///< enough quiet samples were seen
};

struct PreflightFacts {
  bool connected = false;
  bool ended = false;      ///< the replay is over
  bool streaming = false;  ///< samples have come; without them baseline and noise are not asked
  std::uint64_t disk_free_bytes = 0;
  std::uint64_t shot_bytes = 0;  ///< of one shot's codes
  std::size_t ring_samples = 0;
  std::size_t window_samples = 0;
  std::size_t block_samples = 0;
  std::vector<ChannelCondition> channels;  ///< in the order of the shot's channels
};

/// Whether a shot taken now could be stored and reduced: connection, disk, ring against the window,
/// and per gauge calibration, balance of the bridge and noise.
/// @param blank  the shot to come, without samples
[[nodiscard]] std::vector<PreflightItem> preflight(const PreflightFacts& facts, const Shot& blank);

[[nodiscard]] bool passed(const std::vector<PreflightItem>& items);
/// The texts of what did not pass, one line.
[[nodiscard]] std::string failures(const std::vector<PreflightItem>& items);

}  // namespace kolsky
