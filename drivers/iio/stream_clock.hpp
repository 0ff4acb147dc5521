#pragma once

#include <algorithm>
#include <cstdint>

#include "processing/base/time.hpp"

namespace kolsky {

/// How many ticks a stream can have made by now, against the monotonic clock: the bound that tells
/// a counter's jump from a counter that began anew. A source that runs faster than its rate says (a
/// simulated one, accelerated) is given the most speed seen so far.
class StreamClock {
 public:
  StreamClock(std::int64_t start_ns, double rate_Hz) : start_ns_(start_ns), rate_Hz_(rate_Hz) {}

  /// The stream had made so many ticks at that time.
  void note(Tick ticks, std::int64_t now_ns) noexcept {
    const double elapsed = elapsed_s(now_ns);
    if (elapsed > kSettling_s) {
      speed_ = std::max(speed_, static_cast<double>(ticks) / (elapsed * rate_Hz_));
    }
  }

  [[nodiscard]] Tick possible_ticks(std::int64_t now_ns) const noexcept {
    const double time = elapsed_s(now_ns) * speed_ * kClockError + kSlack_s;
    return static_cast<Tick>(std::min(time * rate_Hz_, 4e18));
  }

 private:
  static constexpr double kSettling_s = 0.1;
  static constexpr double kSlack_s = 2.0;
  static constexpr double kClockError = 1.001;  ///< crystals agree to better than 0.1 %

  [[nodiscard]] double elapsed_s(std::int64_t now_ns) const noexcept {
    return static_cast<double>(now_ns - start_ns_) * 1e-9;
  }

  std::int64_t start_ns_;
  double rate_Hz_;
  double speed_ = 1.0;
};

}  // namespace kolsky
