#include "daemon/critic/shot_comparison.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "kolsky/v1/kolsky.pb.h"
#include "processing/base/error.hpp"
#include "processing/criticism/comparing/comparison.hpp"
#include "processing/criticism/impact/impact_study.hpp"

namespace kolsky {

namespace {

constexpr std::size_t kPlaces = 3;

/// @param band_of  the lowest and the highest frequency [Hz] of a tile
template <typename AnyTile, typename BandOf>
void put_places(const std::vector<AnyTile>& tiles, const BandOf& band_of, const Bench& bench,
                v1::Comparison& message) {
  std::vector<const AnyTile*> worst;
  for (const AnyTile& tile : tiles) {
    if (tile.significant) {
      worst.push_back(&tile);
    }
  }
  std::stable_sort(worst.begin(), worst.end(),
                   [](const auto* a, const auto* b) { return a->share > b->share; });
  worst.resize(std::min(worst.size(), kPlaces));
  for (const AnyTile* tile : worst) {
    v1::MisfitPlace& place = *message.add_places();
    const auto [low_Hz, high_Hz] = band_of(*tile);
    place.set_gauge(bench.gauges[tile->gauge].name);
    place.set_window(tile->window);
    place.set_low_hz(low_Hz);
    place.set_high_hz(high_Hz);
    place.set_sigma(tile->sigma);
    place.set_share(tile->share);
  }
}

Misfit compare_impact(const Campaign& campaign, const Model& model, v1::Comparison& message) {
  ImpactStudy study(campaign, judges_whole(model), 0.0, Workers{});
  const Studied studied = study.as_it_is(model);
  const ImpactComparison comparison = study.compare(studied);
  put_places(
      comparison.tiles, [](const ImpactTile& tile) { return std::pair(tile.low_Hz, tile.high_Hz); },
      campaign.bench, message);
  return studied.misfit;
}

Misfit compare_bars(const Campaign& campaign, const Model& model, v1::Comparison& message) {
  Study study(campaign, 0.0, Workers{});
  const Studied studied = study.as_it_is(model);
  const Comparison comparison = compare(study, studied);
  put_places(
      comparison.tiles,
      [&](const Tile& tile) {
        return std::pair(comparison.bands[tile.band].low_Hz, comparison.bands[tile.band].high_Hz);
      },
      campaign.bench, message);
  return studied.misfit;
}

void put_light(const Misfit& misfit, const LightRule& rule, v1::Comparison& message) {
  const double excess = std::max(0.0, misfit.chi2_reduced - 1.0) * misfit.noise_floor_share;
  message.set_excess_share(excess);
  message.set_rule(
      fmt::format("green: chi2/N up to {:g}; else amber up to {:g} of the signal's energy beyond "
                  "noise; else red",
                  rule.green_chi2, rule.amber_share));
  message.set_light(misfit.chi2_reduced <= rule.green_chi2 ? v1::Comparison::GREEN
                    : excess <= rule.amber_share           ? v1::Comparison::AMBER
                                                           : v1::Comparison::RED);
}

}  // namespace

void compare_with_model(const Shot& shot, const ActiveModel& model, v1::Comparison& message) {
  message.Clear();
  message.set_shot_id(shot.id);
  message.set_model_path(model.path.string());
  message.set_model_sha256(model.sha256);
  try {
    const Campaign campaign = read_campaign({shot});
    const Misfit found = campaign.bench.kind == BenchKind::impact
                             ? compare_impact(campaign, model.file.model, message)
                             : compare_bars(campaign, model.file.model, message);
    v1::Misfit& misfit = *message.mutable_misfit();
    misfit.set_chi2_reduced(found.chi2_reduced);
    misfit.set_repeatable_share(found.repeatable_share);
    misfit.set_noise_floor_share(found.noise_floor_share);
    put_light(found, model.rule, message);
    message.set_comparable(true);
  } catch (const InputError& error) {
    message.set_reason(error.what());
  }
}

}  // namespace kolsky
