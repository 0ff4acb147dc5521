#include "processing/reduction/record_faults.hpp"

#include <algorithm>
#include <vector>

#include "processing/reduction/cut_off.hpp"
#include "processing/reduction/first_pulse.hpp"
#include "processing/reduction/quality.hpp"

namespace kolsky {

namespace {

std::vector<double> readings_of_gauge(const ChannelRecord& channel) {
  std::vector<double> readings(channel.codes.size());
  std::ranges::transform(channel.codes, readings.begin(),
                         [&](std::int32_t code) { return channel.value(code); });
  return readings;
}

std::string cut_off_text(const std::string& gauge, const CutOff& top) {
  return "gauge " + gauge + " stays at its extreme for " + std::to_string(top.count) +
         " samples from " + std::to_string(top.first) + " on: it was cut off there";
}

}  // namespace

std::string spoiled_because(const Shot& shot) {
  if (std::string unusable = unusable_because(shot); !unusable.empty()) {
    return unusable;
  }
  // A photo-sensor stays at its levels by nature.
  const std::size_t gauges = std::min(shot.channels.size(), shot.bench.gauges.size());
  for (std::size_t j = 0; j < gauges; ++j) {
    if (const auto top = cut_off(readings_of_gauge(shot.channels[j]))) {
      return cut_off_text(shot.channels[j].gauge, *top);
    }
  }
  return {};
}

std::string too_few_quiet(std::size_t samples) {
  return "too few quiet samples before the pulse: " + std::to_string(samples) + " of at least " +
         std::to_string(kFewestQuiet);
}

}  // namespace kolsky
