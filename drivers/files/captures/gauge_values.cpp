#include "drivers/files/captures/gauge_values.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <limits>

namespace kolsky {

std::vector<double> sample_times_s(const Shot& shot) {
  const Tick whole = shot.trigger ? shot.first_tick - shot.trigger->tick : 0;
  const double fraction = shot.trigger ? shot.trigger->fraction : 0.0;
  const auto numerator = static_cast<double>(shot.rate.numerator);
  const auto denominator = static_cast<double>(shot.rate.denominator);
  std::vector<double> times(shot.samples());
  for (std::size_t i = 0; i < times.size(); ++i) {
    const auto ticks = static_cast<double>(whole + static_cast<Tick>(i));
    times[i] = (ticks - fraction) * denominator / numerator;
  }
  return times;
}

std::vector<double> gauge_values(const ChannelRecord& channel) {
  std::vector<double> values(channel.codes.size());
  std::transform(channel.codes.begin(), channel.codes.end(), values.begin(),
                 [&channel](std::int32_t code) { return channel.value(code); });
  return values;
}

bool fits_16_bits(const ChannelRecord& channel) {
  const auto fits = [](std::int32_t code) {
    return code >= std::numeric_limits<std::int16_t>::min() &&
           code <= std::numeric_limits<std::int16_t>::max();
  };
  return std::all_of(channel.codes.begin(), channel.codes.end(), fits);
}

std::string iso8601_utc(std::int64_t utc_ns) {
  namespace chrono = std::chrono;
  const chrono::sys_time<chrono::nanoseconds> time{chrono::nanoseconds{utc_ns}};
  const auto day = chrono::floor<chrono::days>(time);
  const chrono::year_month_day date{day};
  const chrono::hh_mm_ss clock{time - day};
  return fmt::format("{:04}-{:02}-{:02}T{:02}:{:02}:{:02}.{:09}Z", static_cast<int>(date.year()),
                     static_cast<unsigned>(date.month()), static_cast<unsigned>(date.day()),
                     clock.hours().count(), clock.minutes().count(), clock.seconds().count(),
                     clock.subseconds().count());
}

}  // namespace kolsky
