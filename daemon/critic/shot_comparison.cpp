#include "daemon/critic/shot_comparison.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "kolsky/v1/kolsky.pb.h"
#include "processing/base/error.hpp"
#include "processing/criticism/comparison.hpp"

namespace kolsky {

namespace {

constexpr std::size_t kPlaces = 3;

void put_places(const Comparison& comparison, const Bench& bench, v1::Comparison& message) {
  std::vector<const Tile*> worst;
  for (const Tile& tile : comparison.tiles) {
    if (tile.significant) {
      worst.push_back(&tile);
    }
  }
  std::stable_sort(worst.begin(), worst.end(),
                   [](const Tile* a, const Tile* b) { return a->share > b->share; });
  worst.resize(std::min(worst.size(), kPlaces));
  for (const Tile* tile : worst) {
    v1::MisfitPlace& place = *message.add_places();
    place.set_gauge(bench.gauges[tile->gauge].name);
    place.set_window(tile->window);
    place.set_low_hz(comparison.bands[tile->band].low_Hz);
    place.set_high_hz(comparison.bands[tile->band].high_Hz);
    place.set_sigma(tile->sigma);
    place.set_share(tile->share);
  }
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
    Study study(campaign, 0.0, Workers{});
    const Studied studied = study.as_it_is(model.file.model);
    v1::Misfit& misfit = *message.mutable_misfit();
    misfit.set_chi2_reduced(studied.misfit.chi2_reduced);
    misfit.set_repeatable_share(studied.misfit.repeatable_share);
    misfit.set_noise_floor_share(studied.misfit.noise_floor_share);
    put_places(compare(study, studied), campaign.bench, message);
    put_light(studied.misfit, model.rule, message);
    message.set_comparable(true);
  } catch (const InputError& error) {
    message.set_reason(error.what());
  }
}

}  // namespace kolsky
