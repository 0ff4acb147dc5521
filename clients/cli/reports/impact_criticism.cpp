#include "clients/cli/reports/impact_criticism.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "clients/cli/reports/candidates_page.hpp"
#include "clients/cli/reports/comparison_text.hpp"
#include "clients/cli/reports/share_text.hpp"
#include "clients/terminal/plot.hpp"
#include "processing/base/error.hpp"
#include "processing/criticism/impact/impact_notes.hpp"

namespace kolsky::cli {

namespace {

constexpr std::size_t kShown = 12;
constexpr int kPlotColumns = 100;
constexpr int kPlotRows = 14;

std::string band_of(const ImpactTile& tile) {
  return tile.window == kRebound
             ? ""
             : fmt::format("{:.2g} to {:.2g} kHz", 1e-3 * tile.low_Hz, 1e-3 * tile.high_Hz);
}

std::string gauge_of(const ImpactTile& tile, const Campaign& campaign) {
  return tile.window == kRebound ? "" : campaign.bench.gauges[tile.gauge].name;
}

double speed_of(const ImpactTile& tile, const Campaign& campaign) {
  return campaign.shots[tile.shot].facts.incident_speed_m_per_s.value_or(0.0);
}

Panel force_panel(const SpeedSummary& speed, const std::vector<double>& times_s) {
  return {fmt::format("{:.1f} m/s, mean of {} shots, low-passed", speed.speed_m_per_s, speed.shots),
          {"time since arrival", "s"},
          {"force", "N"},
          {{"measured", times_s, speed.measured_N}, {"foretold", times_s, speed.foretold_N}}};
}

PageSection speeds_section(const std::string& title, const ImpactComparison& comparison,
                           const std::vector<double>& times_s) {
  PageSection section{title, {"Force at the first gauge, as elementary waves carry it there."}};
  PageTable table{{"speed m/s", "shots", "rms % of peak", "noise %", "chi2 of the mean",
                   "peak measured N", "peak foretold N", "restitution measured", "foretold"},
                  {}};
  PanelGroup group{"Force histories", true, {}};
  for (const SpeedSummary& speed : comparison.speeds) {
    table.rows.push_back(
        {fmt::format("{:.1f}", speed.speed_m_per_s), std::to_string(speed.shots),
         fmt::format("{:.2f}", speed.rms_percent), fmt::format("{:.2f}", speed.noise_percent),
         fmt::format("{:.3g}", speed.chi2_reduced), fmt::format("{:.0f}", speed.peak_measured_N),
         fmt::format("{:.0f}", speed.peak_foretold_N),
         speed.restitution_measured > 0.0 ? fmt::format("{:.4f}", speed.restitution_measured) : "",
         fmt::format("{:.4f}", speed.restitution_foretold)});
    group.panels.push_back(force_panel(speed, times_s));
    Panel rest{fmt::format("{:.1f} m/s: measured less foretold", speed.speed_m_per_s),
               {"time since arrival", "s"},
               {"force", "N"},
               {{"deviation", times_s, speed.measured_N}}};
    for (std::size_t n = 0; n < times_s.size(); ++n) {
      rest.series[0].y[n] -= speed.foretold_N[n];
    }
    rest.shaded = 0.02 * speed.noise_percent * speed.peak_foretold_N;
    group.panels.push_back(std::move(rest));
  }
  section.tables.push_back(std::move(table));
  section.groups.push_back(std::move(group));
  return section;
}

PageSection places_section(const ImpactComparison& comparison, const Campaign& campaign) {
  PageSection section{"Where it is", {}};
  PageTable table{
      {"gauge", "window", "band", "speed m/s", "shot", "share", "rms in sigma", "rms of the peak"},
      {}};
  for (const ImpactTile& tile : comparison.tiles) {
    if (tile.significant && table.rows.size() < 2 * kShown) {
      table.rows.push_back({gauge_of(tile, campaign), tile.window, band_of(tile),
                            fmt::format("{:.1f}", speed_of(tile, campaign)),
                            campaign.shots[tile.shot].id, share_text(tile.share),
                            fmt::format("{:.3g}", tile.sigma),
                            share_text(tile.percent_of_peak / 100.0)});
    }
  }
  if (table.rows.empty()) {
    section.text.emplace_back(
        "No single place stands out of the noise and of what the calculation may be off by.");
  } else {
    section.tables.push_back(std::move(table));
  }
  return section;
}

PageSection model_section(const std::string& title, const Model& model) {
  PageTable table{{"effect", "what it is", "parameter", "value", "deviation", "unit"}, {}};
  for (const EffectUse& use : model.effects) {
    const EffectAbout& about = use.effect->about();
    for (std::size_t p = 0; p < about.parameters.size(); ++p) {
      table.rows.push_back({use.id(), p == 0 ? about.definition : "", about.parameters[p].name,
                            fmt::format("{:.5g}", use.values[p].value),
                            use.values[p].sd > 0.0 ? fmt::format("{:.2g}", use.values[p].sd)
                                                   : (use.values[p].free ? "" : "held"),
                            about.parameters[p].unit});
    }
  }
  return {title, {}, {}, {}, {std::move(table)}};
}

/// The end of a sentence on what repeats.
const char* within(Allowance allowance) {
  switch (allowance) {
    case Allowance::kept:
      return ", within what the calculation may be off by.";
    case Allowance::mimicked:
      return ", more than is allowed for the calculation, yet not beyond what an error of its kind "
             "may mimic.";
    case Allowance::exceeded:
      return ", and more than the calculation may be off by.";
  }
  return ".";
}

}  // namespace

void require_kind(const Model& model, const Campaign& campaign) {
  if (model.kind != campaign.bench.kind) {
    throw InputError("model", "is of another kind of bench than the captures",
                     "make one with `kolsky model new --kind`");
  }
}

JsonValue describe_tiles(const ImpactComparison& comparison, const Campaign& campaign) {
  JsonList list;
  for (const ImpactTile& tile : comparison.tiles) {
    if (tile.significant) {
      list.push_back(JsonObject{{"gauge", gauge_of(tile, campaign)},
                                {"window", tile.window},
                                {"band", band_of(tile)},
                                {"band_Hz", std::vector<double>{tile.low_Hz, tile.high_Hz}},
                                {"shot", campaign.shots[tile.shot].id},
                                {"speed_m_per_s", speed_of(tile, campaign)},
                                {"share", tile.share},
                                {"sigma", tile.sigma},
                                {"percent_of_peak", tile.percent_of_peak},
                                {"log_p", tile.log_p},
                                {"significant", true}});
    }
  }
  return list;
}

JsonValue describe_speeds(const ImpactComparison& comparison) {
  JsonList list;
  for (const SpeedSummary& speed : comparison.speeds) {
    list.push_back(JsonObject{
        {"speed_m_per_s", speed.speed_m_per_s},
        {"shots", static_cast<std::int64_t>(speed.shots)},
        {"rms_percent_of_peak", speed.rms_percent},
        {"noise_percent_of_peak", speed.noise_percent},
        {"chi2_reduced", speed.chi2_reduced},
        {"peak_force_N",
         JsonObject{{"measured", speed.peak_measured_N}, {"foretold", speed.peak_foretold_N}}},
        {"restitution", JsonObject{{"measured", speed.restitution_measured > 0.0
                                                    ? JsonValue(speed.restitution_measured)
                                                    : JsonValue(nullptr)},
                                   {"foretold", speed.restitution_foretold}}}});
  }
  return list;
}

std::string impact_words(const ImpactStudy& study, const Studied& studied) {
  std::string text = in_words(studied.misfit, study.campaign().shots.size());
  if (studied.misfit.repeatable_share > studied.misfit.noise_floor_share) {
    text.pop_back();  // the full stop
    // The places below count what is allowed once, a verdict what such an error may mimic.
    text += within(study.allowance(studied));
  }
  return text;
}

std::string speeds_table(const ImpactComparison& comparison) {
  std::string text =
      fmt::format("  {:>9} {:>6} {:>14} {:>9} {:>9} {:>18} {:>18}  {}\n", "speed m/s", "shots",
                  "rms % of peak", "noise %", "chi2", "peak N measured", "foretold", "restitution");
  for (const SpeedSummary& speed : comparison.speeds) {
    const std::string measured = speed.restitution_measured > 0.0
                                     ? fmt::format("{:.4f} measured, ", speed.restitution_measured)
                                     : "";
    text += fmt::format("  {:>9.1f} {:>6} {:>14.2f} {:>9.2f} {:>9.3g} {:>18.0f} {:>18.0f}  {}\n",
                        speed.speed_m_per_s, speed.shots, speed.rms_percent, speed.noise_percent,
                        speed.chi2_reduced, speed.peak_measured_N, speed.peak_foretold_N,
                        measured + fmt::format("{:.4f} foretold", speed.restitution_foretold));
  }
  return text;
}

std::string places_table(const ImpactComparison& comparison, const Campaign& campaign) {
  std::string text;
  std::size_t shown = 0;
  for (const ImpactTile& tile : comparison.tiles) {
    if (tile.significant && shown++ < kShown) {
      text += fmt::format("  {:<8} {:<10} {:<20} {:>9.1f} {:<20} {:>6.1f} % {:>8.2f} {:>8.2f} %\n",
                          gauge_of(tile, campaign), tile.window, band_of(tile),
                          speed_of(tile, campaign), campaign.shots[tile.shot].id,
                          100.0 * tile.share, tile.sigma, tile.percent_of_peak);
    }
  }
  if (shown == 0) {
    return "  no single place stands out of the noise and of the solver's own bounds; `kolsky "
           "diagnose` looks for what is spread over places\n";
  }
  return fmt::format("  {:<8} {:<10} {:<20} {:>9} {:<20} {:>8} {:>8} {:>10}\n", "gauge", "window",
                     "band", "speed m/s", "shot", "share", "sigma", "of peak") +
         text + (shown > kShown ? fmt::format("  and {} places with less\n", shown - kShown) : "");
}

std::string worst_plot(const ImpactComparison& comparison, const std::vector<double>& times_s,
                       const Terminal& terminal) {
  const auto worst = std::max_element(
      comparison.speeds.begin(), comparison.speeds.end(),
      [](const auto& a, const auto& b) { return a.chi2_reduced < b.chi2_reduced; });
  return plot_text(force_panel(*worst, times_s),
                   {std::min(terminal.columns, kPlotColumns), kPlotRows}, terminal.colour);
}

Page impact_page(const std::string& title, const std::vector<std::string>& notes,
                 const ImpactComparison& comparison, ImpactStudy& study, const Studied& studied) {
  Page page;
  page.title = title;
  const Allowance allowance = study.allowance(studied);
  const bool alike = !scatter_doubt(study, studied);
  page.good = alike && allowance != Allowance::exceeded;
  page.headline = page.good ? "What the model foretells differs from the impacts" +
                                  std::string(within(allowance))
                  : alike ? "The model fails; below is at which speeds and when."
                          : "The model fails, and shots of one speed are not alike; below is "
                            "at which speeds, in which shots and when.";
  page.notes = notes;
  page.sections.push_back(
      speeds_section("Speed by speed", comparison, study.residuals().times_s()));
  page.sections.push_back(places_section(comparison, study.campaign()));
  page.sections.push_back(model_section("The model", studied.model));
  return page;
}

Page impact_diagnosis_page(const std::string& title, const std::vector<double>& times_s,
                           const Model& before, const Diagnosis& diagnosis,
                           const ImpactsSeen& seen) {
  Page page;
  page.title = title;
  page.headline = "Verdict: " + kolsky::name_of(diagnosis.verdict);
  for (const std::string& id : diagnosis.effects) {
    page.headline += "; missing: " + id;
    for (const std::string& other : diagnosis.tied_with.at(id)) {
      page.headline += ", not to be told from " + other;
    }
  }
  page.good = diagnosis.verdict == DiagnosisVerdict::adequate ||
              diagnosis.verdict == DiagnosisVerdict::named;
  page.notes = diagnosis.notes;
  for (const NextExperiment& next : diagnosis.next_experiment) {
    page.notes.push_back("next: " + next.change);
  }
  page.sections.push_back(speeds_section("Before", seen.before, times_s));
  page.sections.push_back(
      {"What might be missing", {}, {}, {}, {candidates_table(diagnosis, "speeds")}});
  if (diagnosis.model && !diagnosis.effects.empty()) {
    page.sections.push_back(speeds_section("With what was found", seen.after, times_s));
  }
  page.sections.push_back(
      model_section("The model with what was found", diagnosis.model.value_or(before)));
  return page;
}

}  // namespace kolsky::cli
