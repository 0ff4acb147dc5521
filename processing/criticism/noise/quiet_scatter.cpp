#include "processing/criticism/noise/quiet_scatter.hpp"

#include <algorithm>
#include <cmath>
#include <functional>

namespace kolsky {

namespace {

constexpr std::size_t kFewestShots = 4;

/// Samples before the pulse that so many shots have at least.
std::size_t samples_of(const Campaign& campaign, std::size_t shots) {
  std::vector<std::size_t> samples;
  for (const CampaignShot& shot : campaign.shots) {
    samples.push_back(shot.quiet_samples);
  }
  std::sort(samples.begin(), samples.end(), std::greater<>());
  return samples[shots - 1];
}

}  // namespace

std::vector<std::vector<double>> quiet_scatter(const Campaign& campaign, std::size_t gauge) {
  std::vector<std::vector<double>> quiet;
  for (const CampaignShot& shot : campaign.shots) {
    const auto begin = shot.strain[gauge].begin();
    quiet.emplace_back(begin, begin + static_cast<std::ptrdiff_t>(shot.quiet_samples));
  }
  if (quiet.size() < kFewestShots) {
    return quiet;
  }
  const std::size_t longest = samples_of(campaign, kFewestShots);
  for (std::vector<double>& own : quiet) {
    own.resize(std::min(own.size(), longest));
  }
  for (std::size_t n = 0; n < longest; ++n) {
    double sum = 0.0;
    double shots = 0.0;
    for (const std::vector<double>& own : quiet) {
      sum += n < own.size() ? own[n] : 0.0;
      shots += n < own.size() ? 1.0 : 0.0;
    }
    const double scale = std::sqrt(shots / (shots - 1.0));
    for (std::vector<double>& own : quiet) {
      if (n < own.size()) {
        own[n] = scale * (own[n] - sum / shots);
      }
    }
  }
  return quiet;
}

}  // namespace kolsky
