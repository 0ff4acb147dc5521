#include "processing/criticism/comparing/arrival_windows.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace kolsky {

namespace {

constexpr double kPulseOver = 0.1;  ///< of the peak
/// Share of a pulse's length over which it fades into what comes next.
constexpr double kFade = 0.25;

struct Boundary {
  double time_s = 0.0;
  double fade_s = 0.0;  ///< half the length over which one window gives way to the next
};

struct Layout {
  std::vector<std::string> names;
  std::vector<Boundary> boundaries;  ///< one fewer than names
};

/// How long the pulse lasts at the reference gauge.
double pulse_length_s(const std::vector<double>& record, double start_s, double period_s) {
  const auto begin = static_cast<std::size_t>(
      std::clamp(-start_s / period_s, 0.0, static_cast<double>(record.size()) - 1.0));
  const auto first = record.begin() + static_cast<std::ptrdiff_t>(begin);
  // The first pulse is compression; what a far end sends back has the other sign.
  const auto peak = std::max_element(first, record.end());
  const auto over =
      std::find_if(peak, record.end(), [&](double value) { return value < kPulseOver * *peak; });
  return start_s + static_cast<double>(over - record.begin()) * period_s;
}

double front_speed(const BarScene& bar) {
  return std::sqrt(bar.solid.E1_Pa / bar.density_kg_m3);
}

Layout layout_of(const Scene& scene, std::size_t gauge, std::size_t reference, double pulse_s,
                 double shortest_s) {
  const GaugeScene& own = scene.gauges[gauge];
  const BarScene& input = scene.bars.front();
  const double speed = front_speed(input);
  const double from = scene.gauges[reference].position_m;
  const double foot = own.bar == 0 ? (own.position_m - from) / speed
                                   : (input.length_m - from) / speed +
                                         own.position_m / front_speed(scene.bars[own.bar]);
  const Boundary rise{foot - 0.5 * shortest_s, 0.5 * shortest_s};
  const double fade = std::max(shortest_s, kFade * pulse_s) / 2.0;
  const Boundary fall{foot + pulse_s, fade};
  if (!scene.specimen) {
    return {{kBeforePulse, "incident pulse", "after the pulse"}, {rise, fall}};
  }
  if (own.bar != 0) {
    return {{kBeforePulse, "transmitted pulse", "later"}, {rise, fall}};
  }
  const double back = foot + 2.0 * (input.length_m - own.position_m) / speed;
  return {{kBeforePulse, "incident pulse", "reflected pulse", "later"},
          {rise, {back - 0.5 * shortest_s, 0.5 * shortest_s}, {back + pulse_s, fade}}};
}

/// 0 before the boundary, 1 after; a quarter of a cosine between, so that squares add up to one.
double risen(double time_s, const Boundary& boundary) {
  const double place = (time_s - boundary.time_s) / boundary.fade_s;
  if (place <= -1.0 || place >= 1.0) {
    return place < 0.0 ? 0.0 : 1.0;
  }
  return std::sin(std::numbers::pi / 4.0 * (place + 1.0));
}

std::vector<ArrivalWindow> windows_of(const Layout& layout, double start_s, double period_s,
                                      std::size_t samples) {
  std::vector<ArrivalWindow> windows(layout.names.size());
  const double end_s = start_s + period_s * static_cast<double>(samples);
  for (std::size_t w = 0; w < windows.size(); ++w) {
    ArrivalWindow& window = windows[w];
    window.name = layout.names[w];
    window.start_s = w == 0 ? start_s : std::max(start_s, layout.boundaries[w - 1].time_s);
    window.end_s =
        w == layout.boundaries.size() ? end_s : std::min(end_s, layout.boundaries[w].time_s);
    window.weight.resize(samples);
  }
  for (std::size_t n = 0; n < samples; ++n) {
    const double t = start_s + static_cast<double>(n) * period_s;
    // Later boundaries take from what earlier ones have given.
    double left = 1.0;
    for (std::size_t w = windows.size(); w-- > 0;) {
      const double own = w == 0 ? 1.0 : risen(t, layout.boundaries[w - 1]);
      windows[w].weight[n] = own * left;
      left *= std::sqrt(std::max(0.0, 1.0 - own * own));
    }
  }
  std::erase_if(windows, [](const ArrivalWindow& window) {
    return std::none_of(window.weight.begin(), window.weight.end(),
                        [](double weight) { return weight > 0.5; });
  });
  return windows;
}

}  // namespace

std::vector<std::vector<ArrivalWindow>> arrival_windows(WhiteResiduals& residuals,
                                                        const Composition& composition,
                                                        const std::vector<double>& theta,
                                                        std::size_t shot) {
  const Campaign& campaign = residuals.campaign();
  const JudgedBand& band = residuals.band();
  // Only moduli, densities and places are read off the scene: one place of the path will do.
  const std::vector<Complex> path{Complex(0.0, 2.0 * std::numbers::pi * band.limit_Hz)};
  Scene scene(campaign.bench, campaign.shots[shot].facts, path);
  shape(composition.applied(theta, shot), scene);
  const double start_s = residuals.judged_start_s(shot);
  const double period_s = residuals.judged_period_s();
  const double pulse_s =
      pulse_length_s(residuals.judged_record(shot, campaign.reference), start_s, period_s);
  std::vector<std::vector<ArrivalWindow>> list;
  for (std::size_t j = 0; j < campaign.gauges(); ++j) {
    list.push_back(windows_of(layout_of(scene, j, campaign.reference, pulse_s, 1.0 / band.limit_Hz),
                              start_s, period_s, band.judged));
  }
  return list;
}

}  // namespace kolsky
