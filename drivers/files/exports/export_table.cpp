#include "drivers/files/exports/export_table.hpp"

#include "drivers/files/captures/gauge_values.hpp"

namespace kolsky {

namespace {

/// "g1" in "V" is "g1_V"; a gauge already named so keeps its name.
std::string with_unit(const std::string& name, const std::string& unit) {
  return name.ends_with("_" + unit) ? name : name + "_" + unit;
}

}  // namespace

ExportTable history_table(const Reduction& reduction) {
  if (reduction.ball) {
    return {{"time_s", "s", "time from first touch", reduction.ball->time_s},
            {"force_N", "N", "force on the bar's face, low-passed", reduction.ball->force_N}};
  }
  ExportTable table{
      {"time_s", "s", "time from the pulse's arrival at interface A", reduction.time_s},
      {"stress_Pa", "Pa", "engineering stress, compression positive", reduction.stress_Pa},
      {"strain", "", "engineering strain, compression positive", reduction.strain},
      {"strain_rate_per_s", "1/s", "engineering strain rate", reduction.strain_rate_per_s},
      {"force_front_N", "N", "force on the specimen's front face", reduction.force_front_N},
      {"force_back_N", "N", "force on the specimen's back face", reduction.force_back_N},
      {"incident_strain", "", "incident wave at interface A", reduction.incident},
      {"reflected_strain", "", "reflected wave at interface A", reduction.reflected},
      {"transmitted_strain", "", "transmitted wave at interface B", reduction.transmitted}};
  if (!reduction.strain_true.empty()) {
    table.push_back({"strain_true", "", "true strain", reduction.strain_true});
    table.push_back({"stress_true_Pa", "Pa", "true stress", reduction.stress_true_Pa});
  }
  return table;
}

ExportTable gauge_table(const Shot& shot) {
  ExportTable table{{"time_s", "s",
                     shot.trigger ? "time from the trigger" : "time from the first sample",
                     sample_times_s(shot)}};
  for (const ChannelRecord& channel : shot.channels) {
    table.push_back({with_unit(channel.gauge, channel.unit), channel.unit, "gauge " + channel.gauge,
                     gauge_values(channel)});
  }
  return table;
}

std::string verdict_name(Verdict verdict) {
  switch (verdict) {
    case Verdict::pass:
      return "pass";
    case Verdict::warn:
      return "warn";
    case Verdict::fail:
      break;
  }
  return "fail";
}

}  // namespace kolsky
