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
    place.set_gauge(tile->window == kRebound ? "" : bench.gauges[tile->gauge].name);
    place.set_window(tile->window);
    place.set_low_hz(low_Hz);
    place.set_high_hz(high_Hz);
    place.set_sigma(tile->sigma);
    place.set_share(tile->share);
  }
}

void put_misfit(const Misfit& misfit, v1::Comparison& message) {
  v1::Misfit& own = *message.mutable_misfit();
  own.set_chi2_reduced(misfit.chi2_reduced);
  own.set_repeatable_share(misfit.repeatable_share);
  own.set_noise_floor_share(misfit.noise_floor_share);
}

v1::Comparison::Light light_of(Allowance allowance) {
  switch (allowance) {
    case Allowance::kept:
      return v1::Comparison::GREEN;
    case Allowance::mimicked:
      return v1::Comparison::AMBER;
    case Allowance::exceeded:
      return v1::Comparison::RED;
  }
  return v1::Comparison::LIGHT_UNSPECIFIED;
}

/// No share of the energy bounds what a calculation may be off by: the light is by what is allowed
/// for it.
void compare_impact(const Campaign& campaign, const Model& model, v1::Comparison& message) {
  ImpactStudy study(campaign, judged_stretch(model), 0.0, Workers{});
  const Studied studied = study.as_it_is(model);
  const ImpactComparison comparison = study.compare(studied);
  put_places(
      comparison.tiles, [](const ImpactTile& tile) { return std::pair(tile.low_Hz, tile.high_Hz); },
      campaign.bench, message);
  put_misfit(studied.misfit, message);
  message.set_excess_share(studied.misfit.repeatable_share);
  message.set_rule(
      "green: within noise and what is allowed for the calculation; amber: within what an error of "
      "its kind may mimic; else red");
  message.set_light(light_of(study.allowance(studied)));
}

void put_light(const Misfit& misfit, const LightRule& rule, v1::Comparison& message) {
  const double excess = misfit.repeatable_share;
  message.set_excess_share(excess);
  message.set_rule(
      fmt::format("green: chi2/N up to {:g}; else amber up to {:g} of the signal's energy beyond "
                  "noise; else red",
                  rule.green_chi2, rule.amber_share));
  message.set_light(misfit.chi2_reduced <= rule.green_chi2 ? v1::Comparison::GREEN
                    : excess <= rule.amber_share           ? v1::Comparison::AMBER
                                                           : v1::Comparison::RED);
}

void compare_bars(const Campaign& campaign, const ActiveModel& model, v1::Comparison& message) {
  Study study(campaign, 0.0, Workers{});
  const Studied studied = study.as_it_is(model.file.model);
  const Comparison comparison = compare(study, studied);
  put_places(
      comparison.tiles,
      [&](const Tile& tile) {
        return std::pair(comparison.bands[tile.band].low_Hz, comparison.bands[tile.band].high_Hz);
      },
      campaign.bench, message);
  put_misfit(studied.misfit, message);
  put_light(studied.misfit, model.rule, message);
}

}  // namespace

void compare_with_model(const Shot& shot, const ActiveModel& model, v1::Comparison& message) {
  message.Clear();
  message.set_shot_id(shot.id);
  message.set_model_path(model.path.string());
  message.set_model_sha256(model.sha256);
  try {
    const Campaign campaign = read_campaign({shot});
    if (campaign.bench.kind == BenchKind::impact) {
      compare_impact(campaign, model.file.model, message);
    } else {
      compare_bars(campaign, model, message);
    }
    message.set_comparable(true);
  } catch (const InputError& error) {
    message.set_reason(error.what());
  }
}

}  // namespace kolsky
