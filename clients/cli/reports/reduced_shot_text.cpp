#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "clients/cli/reports/ball_report.hpp"
#include "clients/cli/reports/reduced_shot.hpp"
#include "clients/cli/reports/time_text.hpp"
#include "clients/figure/layout.hpp"
#include "clients/figure/reduction_figure.hpp"
#include "clients/terminal/plot.hpp"
#include "processing/reduction/validity.hpp"

namespace kolsky::cli {
namespace {

constexpr std::size_t kNameColumns = 24;
constexpr std::size_t kVerdictColumns = 6;
constexpr int kPlotColumns = 100;  // wider gives no better view
constexpr int kLoopRows = 16;
constexpr int kForceRows = 9;

std::string what_was_shot(const Shot& shot) {
  if (!shot.bench.specimen.has_value()) {
    return "";
  }
  return report_row("specimen", fmt::format("{} long, {} in diameter",
                                            with_unit(shot.bench.specimen->length_m, "m"),
                                            with_unit(shot.bench.specimen->diameter_m, "m")));
}

std::string arrival_text(const Reduction& reduction) {
  const DisplayUnit unit = display_unit("s", std::abs(reduction.arrival_s));
  return fmt::format("{:.2f} ± {:.2f} {} into the record, at the specimen",
                     reduction.arrival_s * unit.factor, reduction.arrival_sigma_s * unit.factor,
                     unit.name);
}

std::string peaks_text(const LoopSummary& loop) {
  return fmt::format("{} at a strain of {}", with_unit(loop.peak_stress_Pa, "Pa"),
                     with_unit(loop.strain_at_peak, "strain"));
}

std::string loop_text(const LoopSummary& loop) {
  if (!loop.no_loading.empty()) {
    return report_row("summary", "none, for there is no loading: " + loop.no_loading);
  }
  return report_row("peak stress", peaks_text(loop)) +
         report_row("largest strain", with_unit(loop.peak_strain, "strain")) +
         report_row("mean strain rate", fmt::format("{} over the {} of loading",
                                                    with_unit(loop.mean_strain_rate_per_s, "1/s"),
                                                    with_unit(loop.loading_s, "s")));
}

std::string numbers(const Reduction& reduction) {
  return loop_text(summarise(reduction)) + report_row("arrival", arrival_text(reduction)) +
         report_row("band", "up to " + with_unit(reduction.band_limit_Hz, "Hz"));
}

std::string check_text(const Check& check, const Terminal& terminal) {
  const std::size_t indent = 2 + kNameColumns + kVerdictColumns;
  const auto columns = static_cast<std::size_t>(std::clamp(terminal.columns, 60, kPlotColumns));
  const std::vector<std::string> lines = wrapped(check.text, columns - indent);
  std::string text = inked(padded_right(verdict_name(check.verdict), kVerdictColumns),
                           verdict_ink(check.verdict), terminal.colour);
  for (std::size_t i = 0; i < lines.size(); ++i) {
    text += (i == 0 ? "" : "\n" + std::string(indent, ' ')) + lines[i];
  }
  return report_row("  " + check.name, text);
}

// What may be quoted, and up to which frequency the records tell anything.
std::string validity(const ReducedShot& reduced, const Terminal& terminal) {
  const auto columns = static_cast<std::size_t>(std::clamp(terminal.columns, 60, kPlotColumns));
  std::string text;
  std::string name = "may be quoted";
  for (const std::string& line :
       wrapped(quotable_part(reduced.reduction).text, columns - 2 - kNameColumns)) {
    text += report_row(name, line);
    name.clear();
  }
  const double useful_Hz = spectral_quality(reduced.shot, reduced.reduction).useful_band_Hz;
  return text + report_row("useful band",
                           useful_Hz > 0.0 ? "up to " + with_unit(useful_Hz, "Hz") +
                                                 ", signal over 10 dB above the noise on both bars"
                                           : "none: the signal is nowhere 10 dB above the noise");
}

// Where it is not as usual.
std::string how_reduced(const Reduction& reduction, const Bench& bench) {
  std::string text;
  if (reduction.theory != WaveTheory::elementary) {
    text += report_row("dispersion", name_of(reduction.theory));
  }
  if (reduction.stress_from != StressFrom::both_faces || reduction.corrections.any()) {
    text += report_row("stress", fmt::format("{}{}{}", name_of(reduction.stress_from),
                                             reduction.corrections.any() ? ", corrected for " : "",
                                             fmt::join(names_of(reduction.corrections), ", ")));
  }
  if (reduction.corrections.radial_inertia && bench.specimen && !bench.specimen->poisson_ratio) {
    text += report_row("Poisson's ratio", "0.5, that of constant volume: none is filed");
  }
  if (reduction.corrections.friction) {
    text += report_row("friction", fmt::format("{}, up to the strain's top: then faces slide back",
                                               *reduction.corrections.friction));
  }
  return text;
}

std::string as_filed(const Reduction& before) {
  const LoopSummary loop = summarise(before);
  return report_row("as filed", loop.no_loading.empty() ? peaks_text(loop) + ", largest strain " +
                                                              with_unit(loop.peak_strain, "strain")
                                                        : "no loading: " + loop.no_loading);
}

std::string plots(const Reduction& reduction, const Terminal& terminal) {
  const int columns = std::min(terminal.columns, kPlotColumns);
  return "\n" + plot_text(loop_panel(reduction), {columns, kLoopRows}, terminal.colour) + "\n" +
         plot_text(force_panel(reduction), {columns, kForceRows}, terminal.colour);
}

}  // namespace

std::string report_row(const std::string& name, const std::string& text) {
  return "  " + padded_right(name, kNameColumns) + text + "\n";
}

std::string report_head(const ReducedShot& reduced, const Terminal& terminal) {
  return inked(reduced.shot.id, Ink::bold, terminal.colour) + "  " +
         short_time(reduced.shot.utc_ns) + " UTC  " + reduced.capture + "\n";
}

std::string verdicts_text(const Quality& quality, const Terminal& terminal) {
  const Verdict worst = quality.verdict();
  std::string text =
      report_row("verdict", inked(quality.reducible ? verdict_name(worst) : "not reducible",
                                  verdict_ink(worst), terminal.colour) +
                                (quality.reducible ? "" : ": " + quality.reason));
  for (const Check& check : quality.checks) {
    text += check_text(check, terminal);
  }
  return text;
}

std::string report(const ReducedShot& reduced, const Terminal& terminal) {
  if (reduced.shot.bench.kind == BenchKind::impact) {
    return ball_report(reduced, terminal);
  }
  std::string text = report_head(reduced, terminal) + what_was_shot(reduced.shot);
  text += report_row("bars", reduced.reduction.bar_model);
  const bool has_loop = !reduced.reduction.stress_Pa.empty();
  if (has_loop) {
    text += numbers(reduced.reduction);
    text += how_reduced(reduced.reduction, reduced.shot.bench);
    text += validity(reduced, terminal);
  }
  if (reduced.uncertainty) {
    text += uncertainty_report(*reduced.uncertainty);
  }
  if (reduced.as_filed) {
    text += report_row("bench", *reduced.bench) + as_filed(*reduced.as_filed);
  }
  text += verdicts_text(reduced.reduction.quality, terminal);
  return has_loop ? text + plots(reduced.reduction, terminal) : text;
}

}  // namespace kolsky::cli
