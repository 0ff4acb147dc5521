#include "processing/criticism/records/arrival_order.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "processing/reduction/gauge_order.hpp"
#include "processing/reduction/gauge_sign.hpp"

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

/// Whether a gauge's first pulse is the other one than the bars are loaded by in all shots that see
/// it; nothing where none does. It is as loaded where it is so in some shot.
std::optional<bool> reads_otherwise(const Campaign& campaign, std::size_t gauge) {
  std::optional<bool> otherwise;
  for (const CampaignShot& shot : campaign.shots) {
    if (const auto sense = first_sense(shot.strain[gauge], 1.0 / campaign.period_s)) {
      otherwise = otherwise.value_or(true) && *sense != campaign.bench.loading;
    }
  }
  return otherwise;
}

}  // namespace

std::optional<std::string> of_other_sign(const Campaign& campaign) {
  const Bench& bench = campaign.bench;
  std::vector<std::string> odd;
  bool on_input = false;
  std::size_t as_loaded = 0;
  for (std::size_t g = 0; g < bench.gauges.size(); ++g) {
    const std::optional<bool> otherwise = reads_otherwise(campaign, g);
    as_loaded += otherwise && !*otherwise ? 1 : 0;
    if (otherwise.value_or(false)) {
      odd.push_back(bench.gauges[g].name);
      on_input = on_input || bench.gauges[g].bar == "input";
    }
  }
  // Where most pull it may be the loading that is filed wrongly, and then the others are the odd.
  if (odd.empty() || as_loaded < odd.size()) {
    return std::nullopt;
  }
  return other_sign_text(odd, bench.loading, on_input);
}

std::vector<std::string> misfiled_gauges(const Campaign& campaign) {
  std::vector<std::string> lines;
  for (auto& line : {of_other_sign(campaign), out_of_order(campaign)}) {
    if (line) {
      lines.push_back(*line);
    }
  }
  return lines;
}

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
