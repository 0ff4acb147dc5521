#include "clients/cli/reports/comparison_page.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "clients/cli/reports/candidates_page.hpp"
#include "clients/cli/reports/comparison_text.hpp"
#include "clients/cli/reports/diagnosis_text.hpp"
#include "clients/cli/reports/model_text.hpp"
#include "clients/cli/reports/share_text.hpp"
#include "clients/figure/layout.hpp"
#include "processing/criticism/search/confirmed_hum.hpp"

namespace kolsky::cli {

namespace {

constexpr std::size_t kMostShots = 12;  ///< with plots of their own
constexpr std::size_t kMostPlaces = 25;

std::vector<std::string> gauge_names(const Campaign& campaign) {
  std::vector<std::string> names;
  for (const Gauge& gauge : campaign.bench.gauges) {
    names.push_back(gauge.name);
  }
  return names;
}

/// Root mean square in sigma of the tiles that fall into each cell.
class SigmaMap {
 public:
  SigmaMap(const Campaign& campaign, std::string columns_name, std::vector<std::string> columns) {
    map_.rows_name = "gauge";
    map_.columns_name = std::move(columns_name);
    map_.rows = gauge_names(campaign);
    map_.columns = std::move(columns);
    map_.calm = 1.0;
    map_.alarm = 20.0;
    energy_.assign(map_.rows.size(), std::vector<double>(map_.columns.size(), 0.0));
    noise_ = energy_;
  }
  void add(const Tile& tile, std::size_t column) {
    energy_[tile.gauge][column] += tile.energy;
    noise_[tile.gauge][column] += tile.noise.mean;
  }
  [[nodiscard]] HeatMap map() {
    map_.values = energy_;
    for (std::size_t r = 0; r < energy_.size(); ++r) {
      for (std::size_t c = 0; c < energy_[r].size(); ++c) {
        map_.values[r][c] = noise_[r][c] > 0.0 ? std::sqrt(energy_[r][c] / noise_[r][c]) : NAN;
      }
    }
    return map_;
  }

 private:
  HeatMap map_;
  std::vector<std::vector<double>> energy_;
  std::vector<std::vector<double>> noise_;
};

std::vector<std::string> window_names(const Comparison& comparison) {
  // In the order in which waves arrive, whatever gauge they arrive at.
  std::vector<std::string> names;
  for (const char* name : {kBeforePulse, "incident pulse", "reflected pulse", "transmitted pulse",
                           "after the pulse", "later"}) {
    if (std::any_of(comparison.tiles.begin(), comparison.tiles.end(),
                    [&](const Tile& tile) { return tile.window == name; })) {
      names.emplace_back(name);
    }
  }
  return names;
}

std::vector<HeatMap> atlas(const Comparison& comparison, const Campaign& campaign) {
  std::vector<std::string> shots;
  for (const CampaignShot& shot : campaign.shots) {
    shots.push_back(shot.id);
  }
  std::vector<std::string> bands;
  for (const ComparedBand& band : comparison.bands) {
    bands.push_back(band_text(band));
  }
  const std::vector<std::string> windows = window_names(comparison);
  SigmaMap by_shot(campaign, "shot", shots);
  SigmaMap by_band(campaign, "frequency band", bands);
  SigmaMap by_window(campaign, "arrival window", windows);
  for (const Tile& tile : comparison.tiles) {
    by_shot.add(tile, tile.shot);
    by_band.add(tile, tile.band);
    by_window.add(tile,
                  static_cast<std::size_t>(std::find(windows.begin(), windows.end(), tile.window) -
                                           windows.begin()));
  }
  return {by_shot.map(), by_band.map(), by_window.map()};
}

PageTable places(const Comparison& comparison, const Campaign& campaign) {
  PageTable table{{"gauge", "window", "band", "shot", "share of the misfit", "rms in sigma",
                   "rms of the peak", "ln p", "repeats"},
                  {}};
  for (const Tile& tile : comparison.tiles) {
    if (!tile.significant) {
      continue;
    }
    if (table.rows.size() == kMostPlaces) {
      break;
    }
    table.rows.push_back({campaign.bench.gauges[tile.gauge].name, tile.window,
                          band_text(comparison.bands[tile.band]), campaign.shots[tile.shot].id,
                          share_text(tile.share), fmt::format("{:.3g}", tile.sigma),
                          share_text(tile.percent_of_peak / 100.0),
                          fmt::format("{:.1f}", tile.log_p), tile.repeats ? "yes" : "no"});
  }
  return table;
}

PageTable effects_table(const Model& model) {
  PageTable table{{"effect", "stage", "what it is", "parameter", "value", ""}, {}};
  for (const EffectUse& use : model.effects) {
    const EffectAbout& about = use.effect->about();
    for (std::size_t p = 0; p < about.parameters.size(); ++p) {
      const ModelValue& value = use.values[p];
      table.rows.push_back({p == 0 ? use.id() : "", p == 0 ? kolsky::name_of(about.stage) : "",
                            p == 0 ? about.definition : "", about.parameters[p].name,
                            number_text(value.value, value.sd, about.parameters[p].unit),
                            value.free || value.sd > 0.0 ? "" : "held"});
    }
  }
  return table;
}

std::vector<Panel> panels_of(Comparer& comparer, const Study& study, WhiteResiduals& residuals,
                             const Eigen::VectorXd& white, std::size_t shot) {
  const Campaign& campaign = study.campaign();
  const std::span<const double> own(white.data() + shot * residuals.per_shot(),
                                    residuals.per_shot());
  std::vector<double> time(residuals.band().judged);
  for (std::size_t n = 0; n < time.size(); ++n) {
    time[n] = residuals.judged_start_s(shot) + residuals.judged_period_s() * static_cast<double>(n);
  }
  std::vector<Panel> panels;
  for (std::size_t j = 0; j < campaign.gauges(); ++j) {
    const ComparedRecord record = comparer.record(own, shot, j);
    std::vector<double> predicted = record.measured;
    for (std::size_t n = 0; n < predicted.size(); ++n) {
      predicted[n] -= record.deviation[n];
    }
    const std::string& name = campaign.bench.gauges[j].name;
    panels.push_back({name,
                      {"time", "s"},
                      {"strain", "strain"},
                      {{"measured", time, record.measured}, {"predicted", time, predicted}}});
    Panel deviation{name + ": deviation, band: 2 sigma of noise",
                    {"time", "s"},
                    {"strain", "strain"},
                    {{"deviation", time, record.deviation}}};
    deviation.shaded = 2.0 * std::sqrt(residuals.noise().quiet_power(j));
    panels.push_back(std::move(deviation));
  }
  return panels;
}

/// Shots, the one with the largest significant tile first.
std::vector<std::size_t> shots_by_misfit(const Comparison& comparison, std::size_t shots) {
  std::vector<std::size_t> order;
  std::set<std::size_t> seen;
  for (const Tile& tile : comparison.tiles) {
    if (tile.significant && seen.insert(tile.shot).second) {
      order.push_back(tile.shot);
    }
  }
  for (std::size_t n = 0; n < shots; ++n) {
    if (seen.insert(n).second) {
      order.push_back(n);
    }
  }
  return order;
}

/// Of the signal's energy, as `in_words` tells them.
std::vector<ShareBar> shares_of(const Misfit& misfit, std::size_t shots) {
  std::vector<ShareBar> shares{{"signal", 1.0},
                               {"repeats, not explained", misfit.repeatable_share}};
  const double scatter = shots > 1 && scatters(misfit) ? misfit.scatter_share : 0.0;
  if (scatter > 0.0) {
    shares.push_back({"differs from shot to shot", scatter});
  }
  shares.push_back({"noise", misfit.noise_floor_share - scatter});
  return shares;
}

PageSection misfit_section(const std::string& title, const Misfit& misfit, std::size_t shots) {
  return {title,
          {in_words(misfit, shots),
           fmt::format("Chi-square per degree of freedom: {:.4g} over {:.0f}; 1 is noise alone.",
                       misfit.chi2_reduced, misfit.degrees_of_freedom)},
          shares_of(misfit, shots)};
}

/// @param hidden  what to say of what no single place shows
PageSection where_section(const std::string& title, const Comparison& comparison,
                          const Campaign& campaign, const std::string& hidden) {
  PageSection section{
      title,
      {"Rms of the residuals in units of the measured noise: 1 is noise alone. A gauge's deviation "
       "is that from the wave common to all gauges."}};
  section.maps = atlas(comparison, campaign);
  if (!fails_anywhere(comparison)) {
    const std::string together = together_words(comparison.misfit);
    section.text.push_back("No single place stands out of the noise" +
                           (together.empty() ? "." : "; " + together + ".") + hidden);
  }
  return section;
}

/// None where no place fails.
void add_places(Page& page, const Comparison& comparison, const Campaign& campaign) {
  PageTable table = places(comparison, campaign);
  if (table.rows.empty()) {
    return;
  }
  PageSection section{
      "The places that fail",
      {fmt::format("More than noise (false discovery at most 0.5 %), the largest {}.",
                   table.rows.size())}};
  section.tables.push_back(std::move(table));
  page.sections.push_back(std::move(section));
}

/// None where the shots are all about equally strong.
void add_strengths(Page& page, const ShotGroups& by, const Campaign& campaign) {
  if (by.groups.empty()) {
    return;
  }
  PageTable table{{by.by, "shots", "share of the misfit", "rms in sigma"}, {}};
  for (const ShotGroup& group : by.groups) {
    std::string shots;
    for (const std::size_t shot : group.shots) {
      shots += (shots.empty() ? "" : ", ") + campaign.shots[shot].id;
    }
    table.rows.push_back({with_unit(group.low, by.unit) + " to " + with_unit(group.high, by.unit),
                          shots, fmt::format("{:.3g} %", 100.0 * group.share),
                          fmt::format("{:.3g}", group.sigma())});
  }
  page.sections.push_back({"By " + by.by, {}, {}, {}, {std::move(table)}});
}

PageSection records_section(Study& study, const Studied& studied, Comparer& comparer,
                            const Comparison& comparison) {
  PageSection section{"Prediction over measurement",
                      {"Time from the foot of the pulse at the first gauge; compression positive; "
                       "the judged band alone."}};
  const Campaign& campaign = study.campaign();
  for (const std::size_t shot : shots_by_misfit(comparison, campaign.shots.size())) {
    if (section.groups.size() == kMostShots) {
      section.text.push_back(
          fmt::format("The {} shots that fail most, of {}.", kMostShots, campaign.shots.size()));
      break;
    }
    section.groups.push_back(
        {campaign.shots[shot].id, section.groups.empty(),
         panels_of(comparer, study, study.residuals(), studied.fit.residual, shot)});
  }
  return section;
}

std::string headline(const Comparison& comparison, const Model& model, const Campaign& campaign) {
  const auto worst = std::find_if(comparison.regions.begin(), comparison.regions.end(),
                                  [](const Region& region) { return region.significant; });
  if (worst == comparison.regions.end()) {
    std::string words = nothing_fails_words(model, comparison.misfit);
    words.front() = 'N';
    return words + ".";
  }
  return fmt::format(
      "The model fails most at gauge {}, {}, {}: {:.0f} % of the misfit, {:.3g} times the noise{}.",
      campaign.bench.gauges[worst->gauge].name, worst->window,
      band_text(comparison.bands[worst->band]), 100.0 * worst->share, worst->sigma(),
      worst->repeats ? ", and it repeats from shot to shot" : "");
}

std::string verdict_line(const Diagnosis& diagnosis) {
  std::string text = "Verdict: " + kolsky::name_of(diagnosis.verdict);
  for (std::size_t i = 0; i < diagnosis.effects.size(); ++i) {
    const std::string& id = diagnosis.effects[i];
    text += (i == 0 ? "; missing: " : ", ") + id;
    const auto ties = diagnosis.tied_with.find(id);
    if (ties != diagnosis.tied_with.end() && !ties->second.empty()) {
      text += " (not to be told from";
      for (const std::string& other : ties->second) {
        text += " " + other;
      }
      text += ")";
    }
  }
  return text + ".";
}

/// How a verdict goes with places of which none stands out.
std::string hidden_words(const Diagnosis& diagnosis) {
  if (!diagnosis.effects.empty()) {
    return " What was found is spread over places or hides in slow noise.";
  }
  return diagnosis.verdict == DiagnosisVerdict::unknown
             ? " What is unknown is spread over places or hides in slow noise."
             : "";
}

PageSection held_out_section(const Diagnosis& diagnosis, std::size_t shots) {
  const HeldOut& held_out = diagnosis.held_out;
  const std::string misfit =
      diagnosis.effects.empty()
          ? fmt::format("is {:.4g}, and stays so as no effect is added", held_out.before)
          : fmt::format("falls from {:.4g} to {:.4g}", held_out.before, held_out.after);
  PageSection section{
      "Before and after",
      {fmt::format("On {} that the fit did not see, chi-square per residual {}; {} leaves {:.4g}.",
                   shots > 1 ? "shots" : "parts of the one record", misfit,
                   floor_name(held_out.floor), held_out.floor)}};
  section.tables.push_back({{"", "chi-square per degree of freedom", "repeats, share of the signal",
                             "noise, share of the signal"},
                            {{"before", fmt::format("{:.4g}", diagnosis.before.chi2_reduced),
                              share_text(diagnosis.before.repeatable_share),
                              share_text(diagnosis.before.noise_floor_share)},
                             {"after", fmt::format("{:.4g}", diagnosis.after.chi2_reduced),
                              share_text(diagnosis.after.repeatable_share),
                              share_text(diagnosis.after.noise_floor_share)}}});
  return section;
}

}  // namespace

Page comparison_page(const std::string& title, std::vector<std::string> notes, Study& study,
                     const Studied& studied, Comparer& comparer, const Comparison& comparison) {
  const Campaign& campaign = study.campaign();
  const JudgedBand& band = study.residuals().band();
  Page page;
  page.title = title;
  page.headline = headline(comparison, studied.model, campaign);
  page.good =
      !fails_anywhere(comparison) && !fails_together(studied.misfit) && !is_strained(studied.model);
  page.notes = std::move(notes);
  page.notes.push_back(
      fmt::format("{}, {}, judged up to {}", counted(campaign.shots.size(), "shot"),
                  counted(campaign.gauges(), "gauge"), with_unit(band.limit_Hz, "Hz")));
  page.sections.push_back(
      misfit_section("How large the misfit is", studied.misfit, campaign.shots.size()));
  page.sections.push_back(where_section(
      "Where it is", comparison, campaign,
      " `kolsky diagnose` looks for what is spread over places or hides in slow noise."));
  page.sections.push_back(records_section(study, studied, comparer, comparison));
  if (fails_anywhere(comparison)) {
    add_strengths(page, by_strength(comparison, studied.model, campaign), campaign);
    add_places(page, comparison, campaign);
  }
  page.sections.push_back({"The model", {}, {}, {}, {effects_table(studied.model)}});
  return page;
}

Page diagnosis_page(const std::string& title, Study& study, const Model& before,
                    const Diagnosis& diagnosis) {
  const Campaign& campaign = study.campaign();
  Page page;
  page.title = title;
  page.headline = verdict_line(diagnosis);
  page.good = diagnosis.verdict == DiagnosisVerdict::adequate ||
              diagnosis.verdict == DiagnosisVerdict::named;
  page.notes = diagnosis.notes;
  for (const NextExperiment& next : diagnosis.next_experiment) {
    page.notes.push_back("next: " + next.change);
  }
  page.sections.push_back(held_out_section(diagnosis, campaign.shots.size()));
  // Beside the quiet, as `compare` has it: a fit counts as noise what differs from shot to shot.
  const auto fitted = [&](const Model& model) { return judged(study, study.fit(model)); };
  const Studied first = fitted(before);
  const Comparison failed = compare(study, first);
  page.sections.push_back(
      where_section("Where the model failed before", failed, campaign, hidden_words(diagnosis)));
  add_places(page, failed, campaign);
  page.sections.push_back(
      {"What might be missing", {}, {}, {}, {candidates_table(diagnosis, "shots")}});
  const Studied last = diagnosis.model ? fitted(*diagnosis.model) : first;
  Comparer comparer(study.residuals(), last.composition, last.fit.theta);
  const Comparison after = comparer.compare(last.fit.residual, last.misfit);
  if (diagnosis.model) {
    page.sections.push_back(where_section("What is left after", after, campaign, ""));
    add_places(page, after, campaign);
  }
  page.sections.push_back(
      {"The model with what was found", {}, {}, {}, {effects_table(last.model)}});
  page.sections.push_back(records_section(study, last, comparer, after));
  return page;
}

}  // namespace kolsky::cli
