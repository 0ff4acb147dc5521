#include "clients/cli/reports/calibration_report.hpp"

#include <fmt/format.h>

#include <limits>

namespace kolsky::cli {
namespace {

JsonValue measured(const Measured& number) {
  return JsonObject{{"value", number.value}, {"sd", number.sd}};
}

/// A speed that may be anything is no result.
bool tells_speed(const PartResult& part) {
  constexpr double kMost = 0.2;
  return part.wave_speed_m_per_s.sd < kMost * part.wave_speed_m_per_s.value;
}

std::string unit_of(CalibratedNumber::Of of) {
  using Of = CalibratedNumber::Of;
  switch (of) {
    case Of::gain:
      return "-";
    case Of::position:
    case Of::diameter:
    case Of::bar_length:
    case Of::way_to_end:
      return "m";
    case Of::delay:
      return "s";
    case Of::density:
      return "kg/m3";
    case Of::eta2:
      return "Pa s";
    default:
      return "Pa";
  }
}

JsonValue describe_number(const CalibratedNumber& number, BarsLay lay, const Bench& bench) {
  const bool measured_at_all = number.standing != Standing::unexplained;
  const bool filed = number.standing != Standing::unfiled;
  const double none = std::numeric_limits<double>::quiet_NaN();  // null
  JsonObject object{{"id", number.id},
                    {"unit", unit_of(number.of)},
                    {"filed", filed ? number.filed.value : none},
                    {"filed_sd", filed ? number.filed.sd : none},
                    {"measured", measured_at_all ? number.measured.value : none},
                    {"sd", measured_at_all ? number.measured.sd : none},
                    {"combined", measured(number.combined)},
                    {"deviations", measured_at_all && filed ? number.deviations : none},
                    {"verdict", name_of(number.standing)},
                    {"tied_with", number.tied_with}};
  if (!number.gauge.empty()) {
    object.push_back({"gauge", number.gauge});
  }
  if (const auto key = bench_key(number, lay, bench)) {
    object.push_back({"key", key->name});
    object.push_back({"put", measured(key->value)});
  }
  return object;
}

JsonValue describe_areas(const PulseAreas& areas) {
  JsonList ratios;
  for (const AreaRatio& ratio : areas.ratios) {
    ratios.push_back(JsonObject{{"gauge", ratio.gauge},
                                {"over", areas.first_gauge},
                                {"ratio", ratio.ratio.value},
                                {"sd", ratio.ratio.sd}});
  }
  JsonObject object{{"window_s", areas.window_s}, {"ratios", ratios}};
  if (!areas.none_because.empty()) {
    object.push_back({"none_because", areas.none_because});
  }
  return object;
}

JsonValue describe_momentum(const PulseAreas& areas) {
  if (!areas.momentum) {
    return JsonObject{{"none_because", areas.no_momentum_because}};
  }
  return JsonObject{{"gauge", areas.momentum->gauge},
                    {"gain", measured(areas.momentum->gain)},
                    {"shots", static_cast<std::int64_t>(areas.momentum->shots)},
                    {"deviations", areas.momentum_left}};
}

JsonValue describe_part(const PartResult& part, const Bench& bench) {
  JsonList numbers;
  for (const CalibratedNumber& number : part.numbers) {
    numbers.push_back(describe_number(number, part.lay, bench));
  }
  JsonList swapped;
  for (const auto& [one, other] : part.swapped) {
    swapped.emplace_back(std::vector<std::string>{one, other});
  }
  return JsonObject{
      {"bars", name_of(part.lay)},
      {"two_passes", part.two_passes},
      {"shots", static_cast<std::int64_t>(part.shots)},
      {"dispersion", part.exact_waves ? "exact" : "elementary"},
      {"far_end_seen", part.far_end_seen},
      {"chi2_reduced", part.chi2_reduced},
      {"chi2_reduced_as_filed", part.chi2_reduced_as_filed},
      {"wave_speed_m_per_s", tells_speed(part)
                                 ? JsonValue(JsonObject{{"value", part.wave_speed_m_per_s.value},
                                                        {"sd", part.wave_speed_m_per_s.sd},
                                                        {"at_Hz", part.wave_speed_at_Hz}})
                                 : nullptr},
      {"numbers", numbers},
      {"swapped", swapped},
      {"inverted", part.inverted},
      {"areas", describe_areas(part.areas)},
      {"momentum", describe_momentum(part.areas)},
      {"cannot_tell", part.cannot_tell}};
}

std::string row(const CalibratedNumber& number, BarsLay lay, const Bench& bench) {
  const bool filed = number.standing != Standing::unfiled;
  std::string text = fmt::format("  {:<20}", number.id);
  text += filed ? fmt::format("{:>14.7g} ± {:<9.2g}", number.filed.value, number.filed.sd)
                : fmt::format("{:>14}   {:<9}", "-", "");
  // What explains nothing was not measured by it either, nor what the shots do not show.
  const bool measured =
      number.standing != Standing::unexplained && number.standing != Standing::unseen;
  text += !measured ? fmt::format("{:>14}   {:<9}{:>8}  ", "-", "", "")
                    : fmt::format("{:>14.7g} ± {:<9.2g}{:>8}  ", number.measured.value,
                                  number.measured.sd,
                                  filed ? fmt::format("{:.1f}", number.deviations) : "-");
  text += name_of(number.standing);
  if (number.standing == Standing::unseen) {
    text += fmt::format(": the shots tell it to ± {:.2g} only", number.measured.sd);
  }
  if (number.standing == Standing::tied) {
    text += fmt::format(" with {}", fmt::join(number.tied_with, ", "));
  }
  if (number.standing == Standing::differs) {
    const auto key = bench_key(number, lay, bench);
    if (key) {
      text += fmt::format(": put {} = {:.10g}, {}_sd = {:.3g}", key->name, key->value.value,
                          key->edit.key, key->value.sd);
    } else if (number.of == CalibratedNumber::Of::gain) {
      text += fmt::format(": samples are strain already, divide them by {:.6g} on import",
                          number.measured.value);
    } else if (number.of == CalibratedNumber::Of::way_to_end) {
      text += fmt::format(": the bar's length less position_m of {}, of which one is off",
                          number.gauge);
    } else {
      text += ": no number of a bench file";
    }
  }
  return text + "\n";
}

std::string areas_text(const PulseAreas& areas) {
  std::string text = "  pulse areas, no model: ";
  if (!areas.none_because.empty()) {
    text += areas.none_because + "\n";
  } else {
    text += fmt::format("{:.0f} us after each foot\n", 1e6 * areas.window_s);
    for (const AreaRatio& ratio : areas.ratios) {
      text += fmt::format("    {} over {}: {:.5f} ± {:.2g}\n", ratio.gauge, areas.first_gauge,
                          ratio.ratio.value, ratio.ratio.sd);
    }
  }
  if (areas.momentum) {
    text += fmt::format("  striker's momentum: gain of {} {:.5f} ± {:.2g}\n", areas.momentum->gauge,
                        areas.momentum->gain.value, areas.momentum->gain.sd);
  } else if (!areas.no_momentum_because.empty()) {
    text += "  no absolute gain: " + areas.no_momentum_because + "\n";
  }
  return text;
}

std::string part_text(const PartResult& part, const Bench& bench) {
  std::string text = fmt::format(
      "{}: {} shots{}, {} waves{}, reduced chi2 {:.4f} ({:.4f} within what is filed)\n",
      name_of(part.lay), part.shots, part.two_passes ? ", two passes at one gauge" : "",
      part.exact_waves ? "exact" : "elementary", part.far_end_seen ? ", free far end" : "",
      part.chi2_reduced, part.chi2_reduced_as_filed);
  text += tells_speed(part)
              ? fmt::format("  wave speed {:.2f} ± {:.2g} m/s at {:.0f} kHz\n",
                            part.wave_speed_m_per_s.value, part.wave_speed_m_per_s.sd,
                            part.wave_speed_at_Hz / 1e3)
              : "  wave speed: these shots do not tell it; it takes gauges further apart, or bars "
                "that are longer for this pulse\n";
  text += "  number                       filed                   by the shots        deviations\n";
  for (const CalibratedNumber& number : part.numbers) {
    text += row(number, part.lay, bench);
  }
  for (const std::string& gauge : part.inverted) {
    const BenchEdit edit = inverting_edit(gauge, bench);
    text += fmt::format("  gauge {0}: put gauges.{0}.{1} = {2}\n", gauge, edit.key, *edit.text);
  }
  text += areas_text(part.areas);
  if (!part.cannot_tell.empty()) {
    text += "  leave no trace when they move together\n";
    for (const std::string& numbers : part.cannot_tell) {
      text += "    " + numbers + "\n";
    }
  }
  return text;
}

}  // namespace

JsonValue describe(const Calibration& calibration, const Bench& bench) {
  JsonList parts;
  std::vector<std::string> differs;
  for (const PartResult& part : calibration.parts) {
    parts.push_back(describe_part(part, bench));
    for (const CalibratedNumber& number : part.numbers) {
      if (number.standing == Standing::differs) {
        differs.push_back(number.id);
      }
    }
  }
  return JsonObject{{"certificate", name_of(calibration.certificate)},
                    {"differs", differs},
                    {"parts", parts},
                    {"reasons", calibration.reasons},
                    {"warnings", calibration.warnings}};
}

std::string report(const Calibration& calibration, const Bench& bench) {
  std::string text = "certificate: " + name_of(calibration.certificate) + "\n";
  for (const std::string& reason : calibration.reasons) {
    text += "  " + reason + "\n";
  }
  for (const PartResult& part : calibration.parts) {
    text += part_text(part, bench);
  }
  for (const std::string& warning : calibration.warnings) {
    text += "note: " + warning + "\n";
  }
  return text;
}

}  // namespace kolsky::cli
