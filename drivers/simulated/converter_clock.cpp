#include "drivers/simulated/converter_clock.hpp"

#include <algorithm>
#include <cmath>

namespace kolsky {

namespace {

using Seconds = std::chrono::duration<double>;

}  // namespace

ConverterClock::ConverterClock(SampleRate rate, double speed) : rate_(rate), speed_(speed) {}

Tick ConverterClock::now() const {
  if (speed_ == 0.0) {
    return settled_until_;
  }
  const Seconds passed = Clock::now() - start_;
  return start_tick_ + static_cast<Tick>(passed.count() * rate_.Hz() * speed_);
}

ConverterClock::Clock::time_point ConverterClock::time_of(Tick tick) const {
  if (speed_ == 0.0) {
    return Clock::time_point::min();
  }
  const Seconds after(static_cast<double>(tick - start_tick_) / (rate_.Hz() * speed_));
  return start_ + std::chrono::ceil<Clock::duration>(after);
}

void ConverterClock::settle(Tick until) {
  settled_until_ = std::max(settled_until_, until);
}

Tick ConverterClock::next() const {
  return std::max(now(), settled_until_);
}

ConverterClock::Clock::duration ConverterClock::pause(double seconds) const {
  return std::chrono::ceil<Clock::duration>(Seconds(speed_ == 0.0 ? seconds : seconds / speed_));
}

void ConverterClock::paused(double seconds) {
  if (speed_ == 0.0) {
    settled_until_ += static_cast<Tick>(std::llround(seconds * rate_.Hz()));
  }
}

void ConverterClock::set_rate(SampleRate rate) {
  start_tick_ = next();
  start_ = Clock::now();
  rate_ = rate;
}

}  // namespace kolsky
