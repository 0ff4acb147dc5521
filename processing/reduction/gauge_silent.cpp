#include "processing/reduction/gauge_silent.hpp"

#include <cmath>

#include "processing/reduction/first_pulse.hpp"
#include "processing/reduction/formatted.hpp"
#include "processing/reduction/gauge_order.hpp"

namespace kolsky {

namespace {

constexpr double kLeastShare = 0.3;

/// Of the first pulse; none where there is no telling.
struct Seen {
  double height = 0.0;
  bool far_out = false;
};

Seen seen_by(const Shot& shot, std::size_t gauge) {
  const std::vector<double> strain = strain_of_gauge(shot, gauge);
  const auto pulse = first_pulse(strain, shot.rate.Hz());
  return pulse ? Seen{pulse->height, stands_far_out(strain, *pulse)} : Seen{};
}

bool at_one_place(const Bench& bench, const Gauge& a, const Gauge& b) {
  return a.bar == b.bar && std::abs(a.position_m - b.position_m) < bench.bar_of(a).diameter_m;
}

}  // namespace

std::optional<Check> gauge_silent(const Shot& shot) {
  const std::vector<Gauge>& gauges = shot.bench.gauges;
  std::vector<Seen> seen;
  for (std::size_t i = 0; i < gauges.size(); ++i) {
    seen.push_back(seen_by(shot, i));
  }
  for (std::size_t i = 0; i < gauges.size(); ++i) {
    for (std::size_t other = 0; other < gauges.size(); ++other) {
      if (at_one_place(shot.bench, gauges[i], gauges[other]) && seen[other].far_out &&
          seen[i].height < kLeastShare * seen[other].height) {
        const double share = 100.0 * seen[i].height / seen[other].height;
        return Check{
            .name = "gauge_silent",
            .value = share,
            .limit = 100.0 * kLeastShare,
            .unit = "%",
            .verdict = Verdict::fail,
            .text = formatted("%s reads %.0f %% of what %s does at the same place: an open "
                              "lead, a gauge that came off, or a gain that is not as filed",
                              gauges[i].name.c_str(), share, gauges[other].name.c_str())};
      }
    }
  }
  return std::nullopt;
}

}  // namespace kolsky
