#include "clients/figure/recorded_waves_figure.hpp"

#include "clients/figure/layout.hpp"

namespace kolsky {
namespace {

Series known_part(const std::string& name, const std::vector<double>& history, std::size_t known,
                  double period_s) {
  Series series{name, {}, {history.begin(), history.begin() + static_cast<std::ptrdiff_t>(known)}};
  series.x.reserve(known);
  for (std::size_t n = 0; n < known; ++n) {
    series.x.push_back(static_cast<double>(n) * period_s);
  }
  return series;
}

/// One history of every place on one pair of axes.
Panel of_all_places(const RecordedWaves& waves, const Axis& y,
                    std::vector<double> SeparatedWaves::*history, double period_s) {
  Panel panel{y.name, {"time", "s"}, y, {}};
  for (const WavesAtPlace& place : waves.places) {
    panel.series.push_back(known_part("at " + with_unit(place.position_m, "m"),
                                      place.waves.*history, waves.known, period_s));
  }
  return panel;
}

}  // namespace

Panel waves_panel(const RecordedWaves& waves, const WavesAtPlace& place, double period_s) {
  return {"waves at " + with_unit(place.position_m, "m"),
          {"time", "s"},
          {"surface strain", "strain"},
          {known_part("right-going", place.waves.right_going, waves.known, period_s),
           known_part("left-going", place.waves.left_going, waves.known, period_s)}};
}

Figure recorded_waves_figure(const RecordedWaves& waves, double period_s,
                             const std::string& title) {
  Figure figure{title, {"compression positive, up to " + with_unit(waves.band_limit_Hz, "Hz")}, {}};
  for (const WavesAtPlace& place : waves.places) {
    figure.panels.push_back(waves_panel(waves, place, period_s));
  }
  figure.panels.push_back(
      of_all_places(waves, {"stress", "Pa"}, &SeparatedWaves::stress_Pa, period_s));
  figure.panels.push_back(
      of_all_places(waves, {"velocity", "m/s"}, &SeparatedWaves::velocity_m_per_s, period_s));
  return figure;
}

}  // namespace kolsky
