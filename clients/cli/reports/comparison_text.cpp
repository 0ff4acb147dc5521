#include "clients/cli/reports/comparison_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "clients/cli/reports/model_text.hpp"
#include "clients/cli/reports/share_text.hpp"
#include "clients/figure/layout.hpp"
#include "clients/terminal/plot.hpp"

namespace kolsky::cli {

namespace {

constexpr std::size_t kShown = 12;
constexpr int kPlotColumns = 100;
constexpr int kPlotRows = 9;

JsonValue band_limits(const ComparedBand& band) {
  return std::vector<double>{band.low_Hz, band.high_Hz};
}

struct Fades {
  double in_s = 0.0;
  double out_s = 0.0;
};

double deviations_beyond_noise(const Misfit& misfit) {
  return (misfit.chi2_reduced - 1.0) * std::sqrt(misfit.degrees_of_freedom / 2.0);
}

/// Half of a fade lies outside its window's limits.
Fades fades_of(const ArrivalWindow& window, const WhiteResiduals& residuals, std::size_t shot) {
  const double period_s = residuals.judged_period_s();
  Fades fades;
  for (std::size_t n = 0; n < window.weight.size(); ++n) {
    const double t = residuals.judged_start_s(shot) + static_cast<double>(n) * period_s;
    if (window.weight[n] > 0.0) {
      fades.in_s += t < window.start_s ? 2.0 * period_s : 0.0;
      fades.out_s += t > window.end_s ? 2.0 * period_s : 0.0;
    }
  }
  return fades;
}

}  // namespace

std::string band_text(const ComparedBand& band) {
  const DisplayUnit unit = display_unit("Hz", band.high_Hz);
  return fmt::format("{:.3g} to {:.3g} {}", band.low_Hz * unit.factor, band.high_Hz * unit.factor,
                     unit.name);
}

bool scatters(const Misfit& misfit) {
  constexpr double kOfFloor = 0.25;
  return misfit.scatter_share > kOfFloor * misfit.noise_floor_share;
}

std::string in_words(const Misfit& misfit, std::size_t shots) {
  const double floor = misfit.noise_floor_share;
  if (shots == 1) {
    return fmt::format(
        "Of the signal's energy {} is noise and {} more than that is left unexplained; "
        "whether it would come again one shot cannot say.",
        share_text(floor), share_text(misfit.repeatable_share));
  }
  if (scatters(misfit)) {
    return fmt::format(
        "Of the signal's energy {} is noise; the model does not explain {} that "
        "differs "
        "from shot to shot and {} that repeats.",
        share_text(floor - misfit.scatter_share), share_text(misfit.scatter_share),
        share_text(misfit.repeatable_share));
  }
  const std::string sizes = fmt::format(
      "Of the signal's energy {} is noise and {} repeats from shot to shot without the "
      "model explaining it",
      share_text(floor), share_text(misfit.repeatable_share));
  const double ratio = floor > 0.0 ? misfit.repeatable_share / floor : 0.0;
  if (ratio > 1.0) {
    return sizes + fmt::format(": {:.3g} times the noise.", ratio);
  }
  return sizes + (ratio > 0.05 ? fmt::format(": all places together {:.2g} times the noise.", ratio)
                               : ": next to nothing.");
}

std::optional<std::string> doubtful_numbers_text(const Misfit& misfit, std::size_t shots) {
  constexpr double kChance = 1e-4;
  constexpr double kOfOneShot = 2.0;  // how well its noise is known
  const bool fits =
      shots > 1 ? misfit.repeatable_log_p > std::log(kChance) : misfit.chi2_reduced < kOfOneShot;
  if (fits) {
    return std::nullopt;
  }
  return "the records hold more than this model: its numbers may stand in for what is missing, and "
         "their deviations are by noise alone; `kolsky diagnose` looks for what that is";
}

JsonValue describe_tiles(const Comparison& comparison, const Campaign& campaign) {
  JsonList list;
  for (const Tile& tile : comparison.tiles) {
    if (!tile.significant) {
      continue;
    }
    const ComparedBand& band = comparison.bands[tile.band];
    list.push_back(JsonObject{{"gauge", campaign.bench.gauges[tile.gauge].name},
                              {"window", tile.window},
                              {"band", band_text(band)},
                              {"band_Hz", band_limits(band)},
                              {"shot", campaign.shots[tile.shot].id},
                              {"share", tile.share},
                              {"sigma", tile.sigma},
                              {"percent_of_peak", tile.percent_of_peak},
                              {"log_p", tile.log_p},
                              {"repeats", tile.repeats},
                              {"significant", true}});
  }
  return list;
}

JsonValue describe_regions(const Comparison& comparison, const Campaign& campaign) {
  JsonList list;
  for (const Region& region : comparison.regions) {
    const ComparedBand& band = comparison.bands[region.band];
    list.push_back(JsonObject{{"gauge", campaign.bench.gauges[region.gauge].name},
                              {"window", region.window},
                              {"band", band_text(band)},
                              {"band_Hz", band_limits(band)},
                              {"share", region.share},
                              {"sigma", region.sigma()},
                              {"log_p", region.log_p},
                              {"repeat_log_p", region.repeat_log_p},
                              {"repeats", region.repeats},
                              {"significant", region.significant}});
  }
  return list;
}

JsonValue describe_places(const Comparison& comparison, const Comparer& comparer, Study& study) {
  JsonList bands;
  for (const ComparedBand& band : comparison.bands) {
    bands.push_back(band_limits(band));
  }
  JsonList shots;
  JsonList windows;
  const Campaign& campaign = study.campaign();
  for (std::size_t n = 0; n < campaign.shots.size(); ++n) {
    const CampaignShot& shot = campaign.shots[n];
    shots.push_back(shot.id);
    for (std::size_t j = 0; j < campaign.gauges(); ++j) {
      for (const ArrivalWindow& window : comparer.windows(n, j)) {
        const Fades fades = fades_of(window, study.residuals(), n);
        windows.push_back(JsonObject{{"shot", shot.id},
                                     {"gauge", campaign.bench.gauges[j].name},
                                     {"window", window.name},
                                     {"start_s", window.start_s + shot.foot_s},
                                     {"end_s", window.end_s + shot.foot_s},
                                     {"fade_in_s", fades.in_s},
                                     {"fade_out_s", fades.out_s}});
      }
    }
  }
  return JsonObject{
      {"shots", std::move(shots)}, {"bands_Hz", std::move(bands)}, {"windows", std::move(windows)}};
}

JsonValue describe_strengths(const ShotGroups& groups, const Campaign& campaign) {
  if (groups.groups.empty()) {
    return nullptr;
  }
  JsonList list;
  for (const ShotGroup& group : groups.groups) {
    JsonList shots;
    for (const std::size_t shot : group.shots) {
      shots.push_back(campaign.shots[shot].id);
    }
    list.push_back(JsonObject{{"from", group.low},
                              {"to", group.high},
                              {"shots", std::move(shots)},
                              {"share", group.share},
                              {"sigma", group.sigma()},
                              {"log_p", group.log_p()}});
  }
  return JsonObject{{"by", groups.by}, {"unit", groups.unit}, {"groups", std::move(list)}};
}

std::string strengths_table(const ShotGroups& groups, const Campaign& campaign) {
  if (groups.groups.empty()) {
    return "";
  }
  std::string text =
      fmt::format("  {:<32} {:>12} {:>8} {:>8}\n", "by " + groups.by, "shots", "share", "sigma");
  for (const ShotGroup& group : groups.groups) {
    const DisplayUnit unit = display_unit(groups.unit, groups.groups.back().high);
    const std::string range = group.shots.size() == 1
                                  ? fmt::format("{:.4g} {}", group.low * unit.factor, unit.name)
                                  : fmt::format("{:.4g} to {:.4g} {}", group.low * unit.factor,
                                                group.high * unit.factor, unit.name);
    text += fmt::format("  {:<32} {:>5} of {:<3} {:>6.1f} % {:>8.2f}\n", range, group.shots.size(),
                        campaign.shots.size(), 100.0 * group.share, group.sigma());
  }
  return text;
}

bool fails_anywhere(const Comparison& comparison) {
  return std::any_of(comparison.tiles.begin(), comparison.tiles.end(),
                     [](const Tile& tile) { return tile.significant; });
}

bool fails_together(const Misfit& misfit) {
  constexpr double kBeyond = 3.0;
  return deviations_beyond_noise(misfit) > kBeyond;
}

std::string together_words(const Misfit& misfit) {
  return fails_together(misfit)
             ? fmt::format(
                   "all together hold more than the noise before the pulses, by {:.2g} deviations",
                   deviations_beyond_noise(misfit))
             : "";
}

std::string nothing_fails_words(const Model& model, const Misfit& misfit) {
  std::string text = "no single place stands out of the noise";
  if (fails_together(misfit)) {
    text += ", but " + together_words(misfit);
  }
  if (is_strained(model)) {
    text += fails_together(misfit) ? ", and" : ", but";
    text +=
        " filed numbers are strained to that end beyond three deviations: the model is not "
        "adequate while they are";
  }
  return text + "; `kolsky diagnose` looks for what is spread over places or hides in slow noise";
}

std::string places_table(const Comparison& comparison, const Campaign& campaign) {
  std::string text;
  std::size_t shown = 0;
  std::size_t more = 0;
  for (const Region& region : comparison.regions) {
    std::size_t shots = 0;
    double percent = 0.0;
    for (const Tile& tile : comparison.tiles) {
      if (tile.gauge == region.gauge && tile.window == region.window && tile.band == region.band &&
          tile.significant) {
        ++shots;
        percent = std::max(percent, tile.percent_of_peak);
      }
    }
    if (shots == 0) {
      continue;
    }
    if (shown == kShown) {
      ++more;
      continue;
    }
    ++shown;
    text += fmt::format("  {:<8} {:<18} {:<18} {:>6.1f} % {:>8.2f} {:>8.2f} % {:>6} of {:<3} {}\n",
                        campaign.bench.gauges[region.gauge].name, region.window,
                        band_text(comparison.bands[region.band]), 100.0 * region.share,
                        region.sigma(), percent, shots, campaign.shots.size(),
                        campaign.shots.size() == 1 ? "one shot" : (region.repeats ? "yes" : "no"));
  }
  if (shown == 0) {
    return "";
  }
  return fmt::format("  {:<8} {:<18} {:<18} {:>8} {:>8} {:>10} {:>12}  {}\n", "gauge", "window",
                     "band", "share", "sigma", "of peak", "shots", "repeats") +
         text + (more > 0 ? fmt::format("  and {} places with less\n", more) : "");
}

std::string worst_plot(const Comparison& comparison, Comparer& comparer, Study& study,
                       const Eigen::VectorXd& white, const Terminal& terminal) {
  const WhiteResiduals& residuals = study.residuals();
  const Campaign& campaign = study.campaign();
  const bool fails = fails_anywhere(comparison);
  const auto& tiles = comparison.tiles;
  const auto worst =
      fails ? std::find_if(tiles.begin(), tiles.end(),
                           [](const Tile& tile) { return tile.significant; })
            : std::min_element(tiles.begin(), tiles.end(),
                               [](const Tile& a, const Tile& b) { return a.log_p < b.log_p; });
  const std::size_t shot = worst != tiles.end() ? worst->shot : 0;
  const std::size_t gauge = worst != tiles.end() ? worst->gauge : campaign.reference;
  const std::span<const double> own(white.data() + shot * residuals.per_shot(),
                                    residuals.per_shot());
  const ComparedRecord record = comparer.record(own, shot, gauge);
  const double noise = 2.0 * std::sqrt(residuals.noise().quiet_power(gauge));
  double largest = 0.0;
  for (const double value : record.deviation) {
    largest = std::max(largest, std::abs(value));
  }
  Panel panel{fmt::format("{} in {}: deviation, at most {}; noise ±{}",
                          campaign.bench.gauges[gauge].name, campaign.shots[shot].id,
                          with_unit(largest, "strain"), with_unit(noise, "strain")),
              {"time", "s"},
              {"strain", "strain"},
              {{"deviation", {}, record.deviation}, {"2 sigma of noise", {}, {}}}};
  for (std::size_t n = 0; n < record.deviation.size(); ++n) {
    panel.series[0].x.push_back(residuals.judged_start_s(shot) +
                                residuals.judged_period_s() * static_cast<double>(n));
  }
  const double from = panel.series[0].x.front();
  const double to = panel.series[0].x.back();
  panel.series[1].x = {from, to, NAN, from, to};
  panel.series[1].y = {noise, noise, NAN, -noise, -noise};
  Panel above{fmt::format("{} in {}: prediction over measurement",
                          campaign.bench.gauges[gauge].name, campaign.shots[shot].id),
              {"time", "s"},
              {"strain", "strain"},
              {{"measured", panel.series[0].x, record.measured},
               {"predicted", panel.series[0].x, record.measured}}};
  for (std::size_t n = 0; n < record.deviation.size(); ++n) {
    above.series[1].y[n] -= record.deviation[n];
  }
  const PlotSize size{std::min(terminal.columns, kPlotColumns), kPlotRows};
  return (fails ? "  where it fails most:\n"
                : "  no place fails; the one that comes nearest to it:\n") +
         plot_text(above, size, terminal.colour) + plot_text(panel, size, terminal.colour);
}

}  // namespace kolsky::cli
