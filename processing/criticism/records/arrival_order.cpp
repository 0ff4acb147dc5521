#include "processing/criticism/records/arrival_order.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "processing/reduction/first_pulse.hpp"

namespace kolsky {

namespace {

constexpr double kClearly = 3.0;  ///< samples that noise and a delay of one do not make up

double way_to_m(const Bench& bench, const Gauge& gauge) {
  return gauge.bar == "output" ? bench.input.length_m + gauge.position_m : gauge.position_m.value;
}

std::vector<std::size_t> in_filed_order(const Bench& bench) {
  std::vector<std::size_t> order(bench.gauges.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, {},
                           [&](std::size_t j) { return way_to_m(bench, bench.gauges[j]); });
  return order;
}

/// Where the first pulse, in its own sense, last rises past a height [samples].
std::optional<double> passes(const std::vector<double>& strain, const FirstPulse& pulse,
                             double height) {
  const double sense = strain[pulse.rise + 1] < 0.0 ? -1.0 : 1.0;
  std::size_t n = pulse.rise + 1;
  while (n > 0 && sense * strain[n] >= height) {
    --n;
  }
  const double below = sense * strain[n];
  const double above = sense * strain[n + 1];
  return above > below ? std::optional(static_cast<double>(n) + (height - below) / (above - below))
                       : std::nullopt;
}

/// How much later a pulse comes to one gauge than to another [samples]; nothing where it is not
/// seen at both.
std::optional<double> later_by(const CampaignShot& shot, std::size_t gauge, std::size_t than,
                               double rate_Hz) {
  const auto there = first_pulse(shot.strain[gauge], rate_Hz);
  const auto here = first_pulse(shot.strain[than], rate_Hz);
  if (!there || !here) {
    return std::nullopt;
  }
  const double height = 0.5 * std::min(there->height, here->height);
  const auto late = passes(shot.strain[gauge], *there, height);
  const auto early = passes(shot.strain[than], *here, height);
  return late && early ? std::optional(*late - *early) : std::nullopt;
}

/// The least reversal over all shots that see both gauges; nothing where a shot has none.
std::optional<double> reversed_by(const Campaign& campaign, std::size_t first, std::size_t second) {
  std::optional<double> least;
  for (const CampaignShot& shot : campaign.shots) {
    const auto later = later_by(shot, first, second, 1.0 / campaign.period_s);
    if (!later) {
      continue;
    }
    if (*later <= kClearly) {
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
      const std::string& first = bench.gauges[order[i]].name;
      const std::string& second = bench.gauges[order[i + 1]].name;
      return "pulses come to " + second + " " +
             std::to_string(std::lround(*reversed * campaign.period_s * 1e6)) +
             " us or more before " + first +
             ", which the bench files first on their way: were the two exchanged (cables, columns "
             "of the tables, places in the bench file)?";
    }
  }
  return std::nullopt;
}

}  // namespace kolsky
