#include "processing/criticism/selftest/ball_planting.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <random>

#include "processing/criticism/selftest/planting.hpp"

namespace kolsky {

namespace {

const char* const kRebound = "rebound_speed_m_per_s";

/// A photo-sensor's record with the time after the touch run faster: what flies off at another
/// speed passes so much sooner.
void hasten(ChannelRecord& channel, double touch, double ratio) {
  const std::vector<std::int32_t> codes = channel.codes;
  const auto last = static_cast<double>(codes.size() - 1);
  for (std::size_t i = 0; i < codes.size(); ++i) {
    const double place = static_cast<double>(i);
    if (place > touch) {
      const double from = std::min(last, touch + (place - touch) * ratio);
      const auto n = std::min(static_cast<std::size_t>(from), codes.size() - 2);
      const double share = from - static_cast<double>(n);
      channel.codes[i] =
          static_cast<std::int32_t>(std::lround((1.0 - share) * codes[n] + share * codes[n + 1]));
    }
  }
}

/// Whatever says how fast the ball left, now by `ratio`.
void change_rebound(Shot& shot, double touch_s, double ratio) {
  if (const auto filed = shot.meta.find(kRebound); filed != shot.meta.end()) {
    filed->second = std::to_string(std::strtod(filed->second.c_str(), nullptr) * ratio);
  }
  for (std::size_t i = shot.bench.gauges.size(); i < shot.channels.size(); ++i) {
    hasten(shot.channels[i], touch_s * shot.rate.Hz(), ratio);
  }
}

}  // namespace

BallPlanter::BallPlanter(const std::vector<Shot>& shots, ImpactStudy& study, const Studied& studied)
    : shots_(shots),
      study_(study),
      studied_(studied),
      arrival_s_(study.residuals()
                     .foretell(studied.composition, studied.fit.theta, study.executor().first)
                     .arrival_s) {}

std::string BallPlanter::impossible_because(const EffectUse& use) const {
  return use.effect->untestable_because(study_.campaign().bench);
}

std::vector<Shot> BallPlanter::planted(const EffectUse& use, std::size_t worker) const {
  const Campaign& campaign = study_.campaign();
  ImpactResiduals& residuals = study_.residuals();
  const Composition composition(with_use(studied_.model, use), campaign);
  const std::vector<double> theta = numbers_with(studied_, composition, use, campaign.gauges());
  std::vector<Shot> shots = shots_;
  for (std::size_t n = 0; n < shots.size(); ++n) {
    auto with = residuals.sensed(composition, theta, n, arrival_s_[n], 0.0, worker);
    const auto without =
        residuals.sensed(studied_.composition, studied_.fit.theta, n, arrival_s_[n], 0.0, worker);
    for (std::size_t j = 0; j < campaign.gauges(); ++j) {
      for (std::size_t i = 0; i < with.strain[j].size(); ++i) {
        with.strain[j][i] -= without.strain[j][i];
      }
      add_strain(campaign, j, campaign.shots[n].strain[j], with.strain[j], shots[n].channels[j]);
    }
    change_rebound(shots[n], arrival_s_[n], with.rebound_m_per_s / without.rebound_m_per_s);
  }
  return shots;
}

std::vector<Shot> BallPlanter::drawn_anew(std::uint64_t seed, std::size_t worker) const {
  const Campaign& campaign = study_.campaign();
  ImpactResiduals& residuals = study_.residuals();
  const ImpactRecords& records = residuals.records();
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  const double all_faster = records.common_speed_sd * normal(random);
  const std::vector<double> theta = drawn_as_filed(studied_, seed);
  std::vector<Shot> shots = shots_;
  for (std::size_t n = 0; n < shots.size(); ++n) {
    const double faster = all_faster + records.own_speed_sd * normal(random);
    auto own = residuals.sensed(studied_.composition, theta, n, arrival_s_[n], faster, worker);
    const auto noise = fresh_noise(campaign, n, seed);
    for (std::size_t j = 0; j < campaign.gauges(); ++j) {
      for (std::size_t i = 0; i < own.strain[j].size(); ++i) {
        own.strain[j][i] += noise[j][i];
      }
      replace_strain(campaign, j, own.strain[j], campaign.shots[n].quiet_samples,
                     shots[n].channels[j]);
    }
    if (const auto& said = records.rebound[n]) {
      const double off = all_faster + said->sd / said->value * normal(random);
      change_rebound(
          shots[n], arrival_s_[n],
          own.rebound_m_per_s / (said->value * records.wave_speed_m_per_s) * (1.0 + off));
    }
  }
  return shots;
}

}  // namespace kolsky
