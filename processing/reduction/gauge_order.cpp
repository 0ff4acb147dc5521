#include "processing/reduction/gauge_order.hpp"

#include <algorithm>
#include <numeric>

#include "processing/reduction/first_pulse.hpp"
#include "processing/reduction/formatted.hpp"
#include "processing/reduction/stations.hpp"

namespace kolsky {

namespace {

double way_to_m(const Bench& bench, const Gauge& gauge) {
  return gauge.bar == "output" ? bench.input.length_m + gauge.position_m : gauge.position_m.value;
}

/// Where the first pulse, in its own sense, last rises past a height [samples].
std::optional<double> passes(std::span<const double> strain, const FirstPulse& pulse,
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

bool clear(const std::vector<double>& strain, double rate_Hz) {
  const auto pulse = first_pulse(strain, rate_Hz);
  return pulse && stands_far_out(strain, *pulse);
}

}  // namespace

std::vector<double> strain_of_gauge(const Shot& shot, std::size_t gauge) {
  const BarStation own{.channels = {gauge}};
  std::vector<double> record(shot.samples());
  read_raw_station(shot, own, record);
  const auto pulse = first_pulse(record, shot.rate.Hz());
  if (!pulse) {
    return {};
  }
  read_station(shot, own, pulse->quiet, record);
  return record;
}

std::vector<std::size_t> in_filed_order(const Bench& bench) {
  std::vector<std::size_t> order(bench.gauges.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, {},
                           [&](std::size_t j) { return way_to_m(bench, bench.gauges[j]); });
  return order;
}

std::optional<double> later_by(std::span<const double> gauge, std::span<const double> than,
                               double rate_Hz) {
  const auto there = first_pulse(gauge, rate_Hz);
  const auto here = first_pulse(than, rate_Hz);
  if (!there || !here) {
    return std::nullopt;
  }
  const double height = 0.5 * std::min(there->height, here->height);
  const auto late = passes(gauge, *there, height);
  const auto early = passes(than, *here, height);
  return late && early ? std::optional(*late - *early) : std::nullopt;
}

std::string exchanged_text(const Gauge& first, const Gauge& second, const std::string& how_much) {
  return "pulses come to " + second.name + " " + how_much + " before " + first.name +
         ", which the bench files first on their way: were the two exchanged (cables, columns of "
         "the tables, places in the bench file)?";
}

std::optional<Check> gauge_order(const Shot& shot) {
  const std::vector<std::size_t> order = in_filed_order(shot.bench);
  std::vector<std::vector<double>> strain;
  for (const std::size_t gauge : order) {
    strain.push_back(strain_of_gauge(shot, gauge));
  }
  for (std::size_t i = 0; i + 1 < order.size(); ++i) {
    const Gauge& first = shot.bench.gauges[order[i]];
    const Gauge& second = shot.bench.gauges[order[i + 1]];
    // Those of a pair lie at one place: which of them reads more decides which is passed sooner.
    const bool at_one_place = way_to_m(shot.bench, second) - way_to_m(shot.bench, first) <
                              shot.bench.bar_of(first).diameter_m;
    if (at_one_place || !clear(strain[i], shot.rate.Hz()) ||
        !clear(strain[i + 1], shot.rate.Hz())) {
      continue;
    }
    const double later = later_by(strain[i], strain[i + 1], shot.rate.Hz()).value_or(0.0);
    if (later > kClearlyLater) {
      const std::string by = formatted("%.0f us", 1e6 * later * shot.rate.period_s());
      Check check{.name = "gauge_order",
                  .value = later * shot.rate.period_s(),
                  .limit = kClearlyLater * shot.rate.period_s(),
                  .unit = "s",
                  .verdict = Verdict::fail,
                  .text = exchanged_text(first, second, by)};
      return check;
    }
  }
  return std::nullopt;
}

}  // namespace kolsky
