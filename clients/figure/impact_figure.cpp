#include "clients/figure/impact_figure.hpp"

#include "processing/impact/filter.hpp"

namespace kolsky {
namespace {

double interval_of(const impact::ImpactHistory& history) {
  return history.time_s.size() > 1 ? history.time_s[1] - history.time_s[0] : 1.0;
}

}  // namespace

Panel contact_force_panel(const impact::ImpactHistory& history) {
  return {
      "contact force", {"time", "s"}, {"force", "N"}, {{"force", history.time_s, history.force_N}}};
}

Panel contact_radius_panel(const impact::ImpactHistory& history) {
  return {"contact radius",
          {"time", "s"},
          {"radius", "m"},
          {{"radius", history.time_s, history.contact_radius_m}}};
}

Panel probe_rate_panel(const impact::ImpactHistory& history,
                       const std::vector<std::string>& names) {
  Panel panel{"axial strain rate, 20 us mean", {"time", "s"}, {"strain rate", "1/s"}, {}};
  for (std::size_t i = 0; i < history.probe_strain.size(); ++i) {
    panel.series.push_back(
        {names.at(i), history.time_s,
         impact::mean_rate(history.probe_strain[i], interval_of(history), kRateWindow_s)});
  }
  return panel;
}

Panel gauge_strain_panel(const impact::ImpactHistory& history,
                         const std::vector<std::string>& names) {
  Panel panel{
      "bar's surface strain, low-passed at 50 kHz", {"time", "s"}, {"strain", "strain"}, {}};
  for (std::size_t i = 0; i < history.gauge_strain.size(); ++i) {
    panel.series.push_back(
        {names.at(i), history.time_s,
         impact::low_passed(history.gauge_strain[i], interval_of(history), kGaugeCutoff_Hz)});
  }
  return panel;
}

}  // namespace kolsky
