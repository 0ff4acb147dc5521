#include "processing/reduction/gauge_silent.hpp"

#include <cmath>

#include "processing/reduction/first_pulse.hpp"
#include "processing/reduction/formatted.hpp"
#include "processing/reduction/gauge_order.hpp"
#include "processing/reduction/pulse.hpp"

namespace kolsky {

namespace {

constexpr double kLeastShare = 0.3;
constexpr double kFarOut = 20.0;  // of the noise

/// Of the first pulse; none where there is no telling.
struct Seen {
  double height = 0.0;
  double noise_rms = 0.0;
};

Seen seen_by(const Shot& shot, std::size_t gauge) {
  const std::vector<double> strain = strain_of_gauge(shot, gauge);
  const auto pulse = first_pulse(strain, shot.rate.Hz());
  return pulse ? Seen{pulse->height, quiet_before(strain, pulse->quiet).noise_rms} : Seen{};
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
      const bool far_out = seen[other].height > kFarOut * seen[other].noise_rms;
      if (at_one_place(shot.bench, gauges[i], gauges[other]) && far_out &&
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
