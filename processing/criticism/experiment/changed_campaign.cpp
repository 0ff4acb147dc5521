#include "processing/criticism/experiment/changed_campaign.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "processing/criticism/selftest/planting.hpp"

namespace kolsky {

namespace {

/// From a third of today's amplitudes to so many times today's.
void vary_amplitudes(FutureShots& future, double most) {
  const std::size_t shots = future.campaign.shots.size();
  for (std::size_t n = 0; n < shots; ++n) {
    const double share = static_cast<double>(n) / static_cast<double>(shots - 1);
    const double factor = std::pow(3.0 * most, share) / 3.0;
    future.campaign.shots[n].facts.peak_strain *= factor;
    for (double& strain : future.waves.by_shot[n]) {
      strain *= factor;
    }
  }
}

void vary_temperatures(FutureShots& future, double span_K) {
  const std::size_t shots = future.campaign.shots.size();
  for (std::size_t n = 0; n < shots; ++n) {
    const double share = static_cast<double>(n) / static_cast<double>(shots - 1);
    future.campaign.shots[n].facts.warmer_by_K = span_K * (share - 0.5);
  }
}

/// In time, from the foot on.
void stretch_pulses(FutureShots& future, double factor) {
  for (std::size_t n = 0; n < future.campaign.shots.size(); ++n) {
    std::vector<double>& wave = future.waves.by_shot[n];
    const std::vector<double> before = wave;
    const double foot = future.campaign.shots[n].foot_s / future.waves.period_s;
    for (std::size_t i = static_cast<std::size_t>(foot); i < wave.size(); ++i) {
      const double at = foot + (static_cast<double>(i) - foot) / factor;
      const auto low = static_cast<std::size_t>(at);
      const double part = at - static_cast<double>(low);
      wave[i] = low + 1 < before.size() ? (1.0 - part) * before[low] + part * before[low + 1] : 0.0;
    }
  }
}

std::vector<double> places_on_input(const Bench& bench) {
  std::vector<double> places;
  for (const Gauge& gauge : bench.gauges) {
    if (gauge.bar == "input") {
      places.push_back(gauge.position_m.value);
    }
  }
  std::ranges::sort(places);
  return places;
}

double between_gauges_m(const Bench& bench) {
  const std::vector<double> places = places_on_input(bench);
  const double last = places.size() > 1 ? places.back() : bench.input.length_m.value;
  return 0.5 * (places.front() + last);
}

double beyond_gauges_m(const Bench& bench) {
  constexpr double kFurther_m = 0.4;
  constexpr double kFromEnd_m = 0.05;
  return std::min(places_on_input(bench).back() + kFurther_m,
                  bench.input.length_m.value - kFromEnd_m);
}

/// Like the reference gauge but for its place, and as good.
void add_gauge(FutureShots& future, double position_m) {
  Campaign& campaign = future.campaign;
  Gauge gauge = campaign.bench.gauges[campaign.reference];
  gauge.name = "further gauge";
  gauge.position_m.value = position_m;
  campaign.bench.gauges.push_back(gauge);
  campaign.step.push_back(campaign.step[campaign.reference]);
}

void shorten_specimen(FutureShots& future) {
  future.campaign.bench.specimen->length_m.value *= 0.5;
}

bool linear(const EffectUse& use, const Campaign& campaign) {
  Model alone =
      paper_model(campaign.bench.kind, campaign.bench.input.youngs_modulus_Pa.has_value());
  alone.effects.push_back(use);
  const Composition composition(alone, campaign);
  Scene scene(campaign.bench, campaign.shots.front().facts, {});
  shape(composition.applied(composition.start(), 0), scene);
  return !scene.specimen || !scene.specimen->nonlinear();
}

}  // namespace

std::vector<Change> changes_for(const Campaign& campaign) {
  const Bench& bench = campaign.bench;
  const bool split = bench.kind == BenchKind::shpb;
  const double between_m = between_gauges_m(bench);
  const double beyond_m = beyond_gauges_m(bench);
  constexpr double kShorter = 0.5;
  constexpr double kLonger = 1.8;
  constexpr double kSpan_K = 10.0;
  const auto shorter = [=](FutureShots& future) { stretch_pulses(future, kShorter); };
  const auto longer = [=](FutureShots& future) { stretch_pulses(future, kLonger); };
  const auto between = [=](FutureShots& future) { add_gauge(future, between_m); };
  const auto beyond = [=](FutureShots& future) { add_gauge(future, beyond_m); };
  std::vector<Change> changes{
      {"a further gauge between those there are", between},
      {"a further gauge at a larger distance", beyond},
      {"a shorter striker, for higher frequencies", shorter},
      {"a longer striker, for lower frequencies", longer},
      {"a further gauge at a larger distance, and a shorter striker",
       [=](FutureShots& future) {
         beyond(future);
         shorter(future);
       }},
      {"a further gauge at a larger distance, and a longer striker", [=](FutureShots& future) {
         beyond(future);
         longer(future);
       }}};
  if (campaign.shots.size() > 2) {
    // A specimen must not be crushed.
    const double most = split ? 1.0 : 3.0;
    changes.push_back({split ? "a series of amplitudes, from a third of today's up"
                             : "a series of amplitudes, from a third to three times today's",
                       [=](FutureShots& future) { vary_amplitudes(future, most); }});
    changes.push_back({"log the temperature of each shot, over at least 10 K",
                       [=](FutureShots& future) { vary_temperatures(future, kSpan_K); }});
  }
  if (bench.specimen) {
    changes.push_back({"specimens of half the length", shorten_specimen});
  }
  return changes;
}

void foretell(FutureShots& future, const Model& model, const Campaign& measured,
              std::uint64_t seed) {
  Campaign& campaign = future.campaign;
  Model sent = model;
  std::erase_if(sent.effects, [&](const EffectUse& use) {
    return !use.effect->about().base && !linear(use, campaign);
  });
  const Composition composition(sent, campaign);
  for (std::size_t n = 0; n < campaign.shots.size(); ++n) {
    CampaignShot& shot = campaign.shots[n];
    shot.strain =
        readings_of(future.waves.by_shot[n], campaign, composition, composition.start(), n);
    const auto noise = fresh_noise(measured, n, seed);
    // A gauge that is not there yet is as noisy as the reference.
    const auto further = fresh_noise(measured, n, seed + 1)[measured.reference];
    for (std::size_t j = 0; j < shot.strain.size(); ++j) {
      const std::vector<double>& own = j < noise.size() ? noise[j] : further;
      for (std::size_t i = 0; i < std::min(shot.quiet_samples, own.size()); ++i) {
        shot.strain[j][i] += own[i];
      }
    }
  }
}

}  // namespace kolsky
