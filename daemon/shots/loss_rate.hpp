#pragma once

#include <cstdint>
#include <optional>

namespace kolsky {

/// Losses that come by the thousand would fill the disk that shots need with lines about them. So
/// many of each second are told one by one, the others of it in one line; counters have them all.
class LossRate {
 public:
  static constexpr int kMostPerSecond = 20;

  struct Summary {
    std::uint64_t losses = 0;
    std::uint64_t samples = 0;
  };

  /// @return whether this loss is to be told by itself
  [[nodiscard]] bool tells(std::int64_t now_ns, std::uint64_t samples) noexcept {
    if (now_ns - second_ns_ >= kSecond_ns) {
      second_ns_ = now_ns;
      told_ = 0;
    }
    if (told_ < kMostPerSecond) {
      ++told_;
      return true;
    }
    ++kept_back_.losses;
    kept_back_.samples += samples;
    return false;
  }

  /// What was not told by itself of a second that is over; nothing twice.
  [[nodiscard]] std::optional<Summary> kept_back(std::int64_t now_ns) noexcept {
    if (kept_back_.losses == 0 || now_ns - second_ns_ < kSecond_ns) {
      return std::nullopt;
    }
    const Summary summary = kept_back_;
    kept_back_ = {};
    return summary;
  }

 private:
  static constexpr std::int64_t kSecond_ns = 1'000'000'000;

  std::int64_t second_ns_ = -kSecond_ns;
  int told_ = 0;
  Summary kept_back_;
};

}  // namespace kolsky
