#include "clients/figure/reduction_figure.hpp"

#include "clients/figure/layout.hpp"

namespace kolsky {
namespace {

void add_over_time(Panel& panel, const Reduction& reduction, const std::string& name,
                   const std::vector<double>& history) {
  if (history.size() == reduction.time_s.size() && !history.empty()) {
    panel.series.push_back({name, reduction.time_s, history});
  }
}

}  // namespace

Panel loop_panel(const Reduction& reduction) {
  return {"stress-strain",
          {"strain", "strain"},
          {"stress", "Pa"},
          {{"specimen", reduction.strain, reduction.stress_Pa}}};
}

Panel force_panel(const Reduction& reduction) {
  Panel panel{"force on the specimen", {"time", "s"}, {"force", "N"}, {}};
  add_over_time(panel, reduction, "front", reduction.force_front_N);
  add_over_time(panel, reduction, "back", reduction.force_back_N);
  return panel;
}

Panel strain_rate_panel(const Reduction& reduction) {
  Panel panel{"strain rate", {"time", "s"}, {"strain rate", "1/s"}, {}};
  add_over_time(panel, reduction, "specimen", reduction.strain_rate_per_s);
  return panel;
}

Panel wave_panel(const Reduction& reduction) {
  Panel panel{"interface waves", {"time", "s"}, {"bar strain", "strain"}, {}};
  add_over_time(panel, reduction, "incident", reduction.incident);
  add_over_time(panel, reduction, "reflected", reduction.reflected);
  add_over_time(panel, reduction, "transmitted", reduction.transmitted);
  return panel;
}

Figure reduction_figure(const Reduction& reduction, const std::string& title) {
  Figure figure{title, {}, {}};
  std::string origin = "engineering, compression positive";
  if (!reduction.bar_model.empty()) {
    origin += "; bars: " + reduction.bar_model;
  }
  if (reduction.band_limit_Hz > 0.0) {
    origin += "; up to " + with_unit(reduction.band_limit_Hz, "Hz");
  }
  figure.notes.push_back(origin);
  for (const Check& check : reduction.quality.checks) {
    if (check.verdict != Verdict::pass) {
      figure.notes.push_back(check.name + ": " + check.text);
    }
  }
  figure.panels = {loop_panel(reduction), force_panel(reduction), strain_rate_panel(reduction),
                   wave_panel(reduction)};
  return figure;
}

}  // namespace kolsky
