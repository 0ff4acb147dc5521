#pragma once

#include <chrono>

#include "processing/base/time.hpp"

namespace kolsky {

/// The converter's time: which tick it is now and when a tick will be. At speed 0 nothing passes by
/// itself: time is as far as its clients have read.
class ConverterClock {
 public:
  using Clock = std::chrono::steady_clock;

  /// @param speed  factor on real time, or 0
  ConverterClock(SampleRate rate, double speed);

  [[nodiscard]] Tick now() const;

  /// When the tick begins; at speed 0 that is always past.
  [[nodiscard]] Clock::time_point time_of(Tick tick) const;

  /// What comes before `until` is settled, so nothing new can begin there.
  void settle(Tick until);

  /// The first tick that is neither past nor settled.
  [[nodiscard]] Tick next() const;

  /// How long a pause of the converter's time takes its clients.
  [[nodiscard]] Clock::duration pause(double seconds) const;

  /// After such a pause: at speed 0 the time passes now.
  void paused(double seconds);

  /// From the next tick on, ticks are 1/rate apart.
  void set_rate(SampleRate rate);
  [[nodiscard]] SampleRate rate() const noexcept { return rate_; }

 private:
  SampleRate rate_;
  double speed_;
  Clock::time_point start_ = Clock::now();
  Tick start_tick_ = 0;
  Tick settled_until_ = 0;
};

}  // namespace kolsky
