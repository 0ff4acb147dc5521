#include "processing/base/shot.hpp"

#include <algorithm>
#include <cmath>

namespace kolsky {

void cut_at(Shot& shot, double until_s) {
  constexpr double kRounding = 1e-6;  // of a sample
  const double kept = std::ceil(until_s * shot.rate.Hz() - kRounding);
  if (kept >= static_cast<double>(shot.samples())) {
    return;
  }
  const auto samples = static_cast<std::size_t>(kept);
  for (ChannelRecord& channel : shot.channels) {
    channel.codes.resize(std::min(samples, channel.codes.size()));
  }
  const Tick end = shot.first_tick + static_cast<Tick>(samples);
  std::erase_if(shot.gaps, [end](const Gap& gap) { return gap.first_tick >= end; });
}

std::vector<std::size_t> clipped_samples(const ChannelRecord& channel) {
  std::vector<std::size_t> indices;
  for (std::size_t i = 0; i < channel.codes.size(); ++i) {
    if (channel.codes[i] <= channel.code_min || channel.codes[i] >= channel.code_max) {
      indices.push_back(i);
    }
  }
  return indices;
}

}  // namespace kolsky
