#include "processing/criticism/selftest/planting.hpp"

#include <algorithm>
#include <cmath>
#include <random>

#include "processing/algebra/algebra.hpp"
#include "processing/bridge/bridge.hpp"
#include "processing/criticism/search/candidates.hpp"
#include "processing/waves/transform.hpp"

namespace kolsky {

namespace {

std::vector<Complex> spectrum_of(DampedTransform& transform, const std::vector<double>& record) {
  std::vector<Complex> spectrum(transform.bins());
  transform.forward(record, spectrum);
  return spectrum;
}

std::int32_t rounded(const ChannelRecord& channel, double code) {
  return static_cast<std::int32_t>(std::lround(std::clamp(
      code, static_cast<double>(channel.code_min), static_cast<double>(channel.code_max))));
}

}  // namespace

Model with_use(const Model& model, const EffectUse& use) {
  Model after = model;
  std::erase_if(after.effects, [&](const EffectUse& own) { return own.id() == use.id(); });
  after.effects.push_back(use);
  return after;
}

bool two_sided(const EffectUse& use) {
  const EffectParameter& strength = use.effect->about().parameters.front();
  return strength.lower < strength.null_value && strength.upper > strength.null_value;
}

Planter::Planter(const std::vector<Shot>& shots, Study& study, const Studied& studied)
    : shots_(shots),
      campaign_(study.campaign()),
      studied_(studied),
      waves_(source_waves(study, studied)) {}

std::vector<Planter::Record> Planter::through(const Composition& composition,
                                              const std::vector<double>& theta,
                                              std::size_t shot) const {
  return readings_of(waves_.by_shot[shot], campaign_, composition, theta, shot);
}

std::string Planter::impossible_because(const EffectUse& use) const {
  const Composition composition(with_use(studied_.model, use), campaign_);
  Scene scene(campaign_.bench, campaign_.shots.front().facts, {});
  shape(composition.applied(composition.start(), 0), scene);
  if (scene.specimen && scene.specimen->nonlinear()) {
    return "the specimen's answer is not linear: records cannot be changed by adding to them";
  }
  if (!scene.record.maps.empty()) {
    return "a map of records that an expression gives is not planted yet";
  }
  return use.effect->untestable_because(campaign_.bench);
}

std::vector<double> numbers_with(const Studied& studied, const Composition& composition,
                                 const EffectUse& use, std::size_t gauges) {
  const Composition& base = studied.composition;
  std::vector<double> theta = carry(base, studied.fit.theta, composition);
  const bool filed = std::any_of(base.uses().begin(), base.uses().end(),
                                 [&](const EffectUse& own) { return own.id() == use.id(); });
  const bool each_gauge = use.effect->about().each_gauge;
  std::size_t place = 0;
  for (std::size_t i = 0; i < theta.size(); ++i) {
    const FreeNumber& number = composition.numbers()[i];
    if (composition.uses()[number.use].id() == use.id()) {
      // Alike at all gauges it would be a wave's: every other gauge has the opposite.
      const bool strength =
          !use.effect->about().parameters[number.parameter].auxiliary() && each_gauge;
      const double sign = strength && place++ % gauges % 2 == 1 ? -1.0 : 1.0;
      const double value = sign * use.values[number.parameter].value;
      // A filed number is moved from where the fit has it.
      theta[i] =
          filed ? theta[i] + (value - use.effect->about().parameters[number.parameter].null_value) /
                                 number.scale
                : number.theta_of(value);
    }
  }
  return theta;
}

std::vector<double> drawn_as_filed(const Studied& studied, std::uint64_t seed) {
  const Composition& composition = studied.composition;
  std::vector<double> theta = studied.fit.theta;
  std::vector<Eigen::Index> filed;
  for (std::size_t i = 0; i < theta.size(); ++i) {
    const FreeNumber& number = composition.numbers()[i];
    // What is only bounded, as a hum's amplitudes are, is no number that anybody filed.
    if (number.prior_sd > 0.0 && !composition.uses()[number.use].effect->about().each_gauge) {
      filed.push_back(static_cast<Eigen::Index>(i));
    }
  }
  if (filed.empty()) {
    return theta;
  }
  const Eigen::MatrixXd precision = composition.prior_precision()(filed, filed);
  const SymmetricEigen known(precision);
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  Eigen::VectorXd drawn(known.eigenvalues().size());
  for (Eigen::Index i = 0; i < drawn.size(); ++i) {
    drawn[i] = normal(random) / std::sqrt(known.eigenvalues()[i]);
  }
  const Eigen::VectorXd off = known.eigenvectors() * drawn;
  for (std::size_t i = 0; i < filed.size(); ++i) {
    const auto at = static_cast<std::size_t>(filed[i]);
    const FreeNumber& number = composition.numbers()[at];
    theta[at] =
        number.inside(number.theta_of(number.prior_mean) + off[static_cast<Eigen::Index>(i)]);
  }
  return theta;
}

void add_strain(const Campaign& campaign, std::size_t gauge, const std::vector<double>& strain,
                const std::vector<double>& more, ChannelRecord& channel) {
  const Gauge& own = campaign.bench.gauges[gauge];
  const BridgeConversion bridge(own, campaign.bench.bar_of(own), campaign.bench.positive);
  for (std::size_t i = 0; i < channel.codes.size(); ++i) {
    const double reading = bridge.reading(strain[i] + more[i]) - bridge.reading(strain[i]);
    channel.codes[i] =
        rounded(channel, static_cast<double>(channel.codes[i]) + reading / channel.scale);
  }
}

void replace_strain(const Campaign& campaign, std::size_t gauge, const std::vector<double>& strain,
                    std::size_t quiet, ChannelRecord& channel) {
  const Gauge& own = campaign.bench.gauges[gauge];
  const BridgeConversion bridge(own, campaign.bench.bar_of(own), campaign.bench.positive);
  double baseline = 0.0;
  for (std::size_t i = 0; i < quiet; ++i) {
    baseline += static_cast<double>(channel.codes[i]) / static_cast<double>(quiet);
  }
  for (std::size_t i = 0; i < channel.codes.size(); ++i) {
    channel.codes[i] = rounded(channel, baseline + bridge.reading(strain[i]) / channel.scale);
  }
}

std::vector<Shot> Planter::planted(const EffectUse& use) const {
  const Composition composition(with_use(studied_.model, use), campaign_);
  const std::vector<double> theta = numbers_with(studied_, composition, use, campaign_.gauges());
  std::vector<Shot> shots = shots_;
  for (std::size_t n = 0; n < shots.size(); ++n) {
    const auto with = through(composition, theta, n);
    const auto without = through(studied_.composition, studied_.fit.theta, n);
    for (std::size_t j = 0; j < campaign_.gauges(); ++j) {
      Record more = with[j];
      for (std::size_t i = 0; i < more.size(); ++i) {
        more[i] -= without[j][i];
      }
      add_strain(campaign_, j, campaign_.shots[n].strain[j], more, shots[n].channels[j]);
    }
  }
  return shots;
}

std::vector<std::vector<double>> fresh_noise(const Campaign& campaign, std::size_t shot,
                                             std::uint64_t seed) {
  // White numbers through what was recorded before a pulse: the sum over shots has the mean of
  // their correlations, between samples and between gauges.
  const std::size_t samples = campaign.shots[shot].strain.front().size();
  std::mt19937_64 random(seed * 1000003U + shot);
  std::normal_distribution<double> normal;
  std::vector<std::vector<double>> noise(campaign.gauges(), std::vector<double>(samples, 0.0));
  const double shots = static_cast<double>(campaign.shots.size());
  for (const CampaignShot& own : campaign.shots) {
    const std::size_t quiet = own.quiet_samples;
    DampedTransform transform(samples + 2 * quiet, campaign.period_s);
    std::vector<double> drawn(samples + quiet);
    for (double& value : drawn) {
      value = normal(random) / std::sqrt(shots * static_cast<double>(quiet));
    }
    const auto white = spectrum_of(transform, drawn);
    for (std::size_t j = 0; j < noise.size(); ++j) {
      auto spectrum = spectrum_of(
          transform,
          {own.strain[j].begin(), own.strain[j].begin() + static_cast<std::ptrdiff_t>(quiet)});
      for (std::size_t k = 0; k < spectrum.size(); ++k) {
        spectrum[k] *= white[k];
      }
      std::vector<double> whole(samples + quiet);
      transform.inverse(spectrum, whole);
      for (std::size_t i = 0; i < samples; ++i) {
        noise[j][i] += whole[i + quiet];
      }
    }
  }
  return noise;
}

std::vector<Shot> Planter::drawn_anew(std::uint64_t seed) const {
  const std::vector<double> theta = drawn_as_filed(studied_, seed);
  std::vector<Shot> shots = shots_;
  for (std::size_t n = 0; n < shots.size(); ++n) {
    auto strain = through(studied_.composition, theta, n);
    const auto noise = fresh_noise(campaign_, n, seed);
    for (std::size_t j = 0; j < campaign_.gauges(); ++j) {
      for (std::size_t i = 0; i < strain[j].size(); ++i) {
        strain[j][i] += noise[j][i];
      }
      replace_strain(campaign_, j, strain[j], campaign_.shots[n].quiet_samples,
                     shots[n].channels[j]);
    }
  }
  return shots;
}

}  // namespace kolsky
