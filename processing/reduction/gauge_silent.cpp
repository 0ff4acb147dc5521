#include "processing/reduction/gauge_silent.hpp"

#include <algorithm>
#include <cmath>

#include "processing/reduction/formatted.hpp"
#include "processing/reduction/gauge_order.hpp"

namespace kolsky {

namespace {

constexpr double kLeastShare = 0.3;

double most_of(const std::vector<double>& strain) {
  double most = 0.0;
  for (const double e : strain) {
    most = std::max(most, std::abs(e));
  }
  return most;
}

}  // namespace

std::optional<Check> gauge_silent(const Shot& shot) {
  const std::vector<Gauge>& gauges = shot.bench.gauges;
  std::vector<double> most;
  for (std::size_t i = 0; i < gauges.size(); ++i) {
    most.push_back(most_of(strain_of_gauge(shot, i)));
  }
  for (std::size_t i = 0; i < gauges.size(); ++i) {
    for (std::size_t other = 0; other < gauges.size(); ++other) {
      if (gauges[i].bar == gauges[other].bar && most[i] < kLeastShare * most[other]) {
        const double share = 100.0 * most[i] / most[other];
        return Check{
            .name = "gauge_silent",
            .value = share,
            .limit = 100.0 * kLeastShare,
            .unit = "%",
            .verdict = Verdict::fail,
            .text = formatted("%s reads %.0f %% of what %s does on the same bar: an open "
                              "lead, a gauge that came off, or a gain that is not as filed",
                              gauges[i].name.c_str(), share, gauges[other].name.c_str())};
      }
    }
  }
  return std::nullopt;
}

}  // namespace kolsky
