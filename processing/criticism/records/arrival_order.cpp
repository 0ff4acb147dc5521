#include "processing/criticism/records/arrival_order.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "processing/reduction/gauge_order.hpp"

namespace kolsky {

namespace {

/// The least reversal over all shots that see both gauges; nothing where a shot has none.
std::optional<double> reversed_by(const Campaign& campaign, std::size_t first, std::size_t second) {
  std::optional<double> least;
  for (const CampaignShot& shot : campaign.shots) {
    const auto later = later_by(shot.strain[first], shot.strain[second], 1.0 / campaign.period_s);
    if (!later) {
      continue;
    }
    if (*later <= kClearlyLater) {
      return std::nullopt;
    }
    least = std::min(least.value_or(*later), *later);
  }
  return least;
}

}  // namespace

std::optional<std::string> out_of_order(const Campaign& campaign) {
  const Bench& bench = campaign.bench;
  const std::vector<std::size_t> order = in_filed_order(bench);
  for (std::size_t i = 0; i + 1 < order.size(); ++i) {
    if (const auto reversed = reversed_by(campaign, order[i], order[i + 1])) {
      const long reversed_us = std::lround(*reversed * campaign.period_s * 1e6);
      return exchanged_text(bench.gauges[order[i]], bench.gauges[order[i + 1]],
                            std::to_string(reversed_us) + " us or more");
    }
  }
  return std::nullopt;
}

}  // namespace kolsky
