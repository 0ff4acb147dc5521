#include "processing/criticism/search/own_strengths.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>
#include <random>

#include "processing/algebra/algebra.hpp"
#include "processing/criticism/search/amplitude_over_shots.hpp"
#include "processing/criticism/search/hum_slopes.hpp"
#include "processing/criticism/search/quiet_slopes.hpp"
#include "processing/criticism/search/safeguards.hpp"
#include "processing/criticism/search/search_trials.hpp"

namespace kolsky {

namespace {

/// Of what it takes to make a claim. What was found so once falls only by half: else it would come
/// and go with the rest of the model.
double share_asked(Claim claim) {
  return claim == Claim::standing ? 0.5 : 1.0;
}

/// Standard deviation over mean.
double spread_of(const Eigen::VectorXd& sizes) {
  const double mean = sizes.mean();
  const auto count = static_cast<double>(sizes.size());
  const double variance = (sizes.array() - mean).square().sum() / std::max(1.0, count - 1.0);
  return mean > 0.0 ? std::sqrt(variance) / mean : 1.0;
}

/// A hum is as strong in every shot; slow noise that was taken for one is not. Its amplitudes are
/// normal in cosine and sine: so much alike they must be as fewer than one in a hundred such sets.
bool amplitudes_agree(const Eigen::VectorXd& sizes) {
  constexpr int kDraws = 20000;
  constexpr double kChance = 0.01;
  if (sizes.size() < 3) {
    return false;
  }
  const double found = spread_of(sizes);
  std::mt19937_64 random(kSearchSeed);
  std::normal_distribution<double> normal;
  Eigen::VectorXd draw(sizes.size());
  int alike = 0;
  for (int n = 0; n < kDraws; ++n) {
    for (double& size : draw) {
      const double cosine = normal(random);
      size = std::hypot(cosine, normal(random));
    }
    alike += spread_of(draw) <= found ? 1 : 0;
  }
  return alike < kChance * kDraws;
}

/// The slopes before the pulses must follow those found: regression through the origin.
bool slopes_agree(const std::vector<double>& found, const std::vector<double>& before) {
  double cross = 0.0;
  double square = 0.0;
  for (std::size_t n = 0; n < found.size(); ++n) {
    cross += found[n] * before[n];
    square += found[n] * found[n];
  }
  const double share = cross / square;
  double rest = 0.0;
  for (std::size_t n = 0; n < found.size(); ++n) {
    const double e = before[n] - share * found[n];
    rest += e * e;
  }
  const double sd = std::sqrt(rest / (static_cast<double>(found.size()) - 1.0) / square);
  constexpr double kSigma = 4.0;
  return found.size() > 2 && share > 0.5 && share < 1.5 && share > kSigma * sd;
}

/// Nearer to products than noise comes in one of a thousand, or in one of a hundred where slow
/// noise does not gain as much, and not for one gauge's sake.
bool are_products(const ProductTest& test, Claim claim) {
  const double chance = claim == Claim::beyond_slow_noise ? -4.6 : -6.9;
  constexpr double kBeyond = 25.0;
  return test.log_p < share_asked(claim) * chance &&
         test.beyond_one_gauge > share_asked(claim) * kBeyond;
}

/// Slopes before each shot's pulse, sum over the gauges that an addition is in: of the addition
/// as fitted and of the records, less what else the model adds to them.
struct Slopes {
  std::vector<double> found;
  std::vector<double> before;
  SlopesByShot of_others;         ///< what else the model adds
  SlopesByShot of_all_additions;  ///< the addition, too
};

/// Slopes before a shot's pulse of those additions that `wanted` picks, by gauge.
template <typename Wanted>
std::vector<double> slopes_added(const Studied& studied, const Campaign& campaign,
                                 std::size_t of_shot, Wanted wanted) {
  const CampaignShot& shot = campaign.shots[of_shot];
  Scene scene(campaign.bench, shot.facts, {});
  scene.record.additions.resize(campaign.gauges());
  for (const AppliedEffect& effect : studied.composition.applied(studied.fit.theta, of_shot)) {
    if (effect.effect->about().stage == Stage::record && wanted(effect)) {
      effect.effect->apply(scene, effect.values, effect.gauge);
    }
  }
  std::vector<double> slopes(campaign.gauges());
  for (std::size_t j = 0; j < campaign.gauges(); ++j) {
    const std::vector<double>& addition = scene.record.additions[j];
    slopes[j] = addition.empty() ? 0.0 : slope_before(shot, addition);
  }
  return slopes;
}

Slopes slopes_of(const Studied& studied, const std::string& id, const Campaign& campaign) {
  const EffectUse& use = *studied.model.find(id);
  const auto of_gauge = [&](std::size_t j) {
    return use.gauge.empty() || campaign.bench.gauges[j].name == use.gauge;
  };
  const auto is_own = [&](const AppliedEffect& effect) {
    return effect.effect == use.effect &&
           (!use.effect->about().per_gauge || of_gauge(effect.gauge));
  };
  Slopes slopes;
  for (std::size_t n = 0; n < campaign.shots.size(); ++n) {
    const CampaignShot& shot = campaign.shots[n];
    const std::vector<double> own = slopes_added(studied, campaign, n, is_own);
    const std::vector<double> others = slopes_added(
        studied, campaign, n, [&](const AppliedEffect& effect) { return !is_own(effect); });
    double found = 0.0;
    double before = 0.0;
    std::vector<double>& all = slopes.of_all_additions.emplace_back(others);
    for (std::size_t j = 0; j < campaign.gauges(); ++j) {
      all[j] += own[j];
      if (of_gauge(j)) {
        found += own[j];
        before += slope_before(shot, shot.strain[j]) - others[j];
      }
    }
    slopes.of_others.push_back(others);
    slopes.found.push_back(found);
    slopes.before.push_back(before);
  }
  return slopes;
}

/// Amplitudes by shot and, where they differ, gauge, their cosine and sine parts as one complex
/// number.
Eigen::MatrixXcd amplitudes_of(const Studied& studied, const std::string& id,
                               const Campaign& campaign) {
  // In the order of the composition: by parameter, then shot, then gauge.
  std::vector<std::vector<double>> found(2);
  for (std::size_t i = 0; i < studied.fit.theta.size(); ++i) {
    const FreeNumber& number = studied.composition.numbers()[i];
    if (number.shot >= 0 && studied.composition.uses()[number.use].id() == id &&
        number.parameter < found.size()) {
      found[number.parameter].push_back(number.value_at(studied.fit.theta[i]));
    }
  }
  const auto shots = static_cast<Eigen::Index>(campaign.shots.size());
  Eigen::MatrixXcd amplitudes(shots, static_cast<Eigen::Index>(found[0].size()) / shots);
  for (Eigen::Index n = 0; n < amplitudes.rows(); ++n) {
    for (Eigen::Index j = 0; j < amplitudes.cols(); ++j) {
      const auto at = static_cast<std::size_t>(n * amplitudes.cols() + j);
      amplitudes(n, j) = {found[0][at], found[1][at]};
    }
  }
  return amplitudes;
}

/// What is alike at all gauges stands in their mean before the pulse; of what is found behind it
/// only a part may show, for waves from gauge to gauge carry the rest: more than its sign is not
/// asked for.
bool seen_at_all_gauges(const Slopes& slopes, const Campaign& campaign, Claim claim) {
  return std::inner_product(slopes.found.begin(), slopes.found.end(), slopes.before.begin(), 0.0) >
             0.0 &&
         log_chance_of_common_slopes(campaign, slopes.of_others) < share_asked(claim) * kFalseClaim;
}

/// A record is a fraction of a hum's period, in which a slope of each shot's own is nearly all of
/// it: with phases free, whatever wanders slowly and alike at all gauges is a hum of some
/// amplitude, but none that is well known.
bool amplitude_stands(const Studied& studied, const std::string& id, Claim claim) {
  constexpr double kSigma = 5.0;
  const Amplitude amplitude = amplitude_over_shots(studied, id);
  return amplitude.value > share_asked(claim) * kSigma * amplitude.sd;
}

/// Less the hum that was found in all of a record, what came before the pulse slopes no longer as
/// gauges do together. What wanders turns otherwise there than a hum would; and where gauges are
/// seen to turn together there, what they slope by must be more than that does.
bool wanders_on(const Studied& studied, const EffectUse& hum, const Campaign& campaign,
                const Slopes& slopes, Claim claim) {
  if (wanders_in_common(campaign) &&
      log_chance_of_common_slopes(campaign, slopes.of_others) > share_asked(claim) * kFalseClaim) {
    return true;
  }
  if (hum.alike) {
    return log_chance_of_common_slopes(campaign, slopes.of_all_additions) < kFalseClaim;
  }
  SlopesByShot less = slopes_of_products(studied, hum.id(), campaign, slopes.of_others);
  for (std::size_t n = 0; n < less.size(); ++n) {
    std::ranges::transform(less[n], slopes.of_others[n], less[n].begin(), std::plus{});
  }
  return log_chance_of_common_slopes(campaign, less) < kFalseClaim;
}

}  // namespace

bool own_strengths_confirmed(const Studied& studied, const std::string& id,
                             const Campaign& campaign, Claim claim) {
  const EffectUse* use = studied.model.find(id);
  if (use == nullptr || !use->per_shot) {
    return true;
  }
  if (use->effect->about().quadrature && !amplitude_stands(studied, id, claim)) {
    return false;
  }
  const Slopes slopes = slopes_of(studied, id, campaign);
  if (use->effect->about().quadrature && wanders_on(studied, *use, campaign, slopes, claim)) {
    return false;
  }
  if (const auto test = product_test_of(studied, id, campaign)) {
    return are_products(*test, claim);
  }
  if (use->alike && seen_at_all_gauges(slopes, campaign, claim)) {
    return true;
  }
  if (use->alike && !amplitudes_agree(amplitudes_of(studied, id, campaign).col(0).cwiseAbs())) {
    return false;
  }
  return slopes_agree(slopes.found, slopes.before);
}

bool slow_noise_excluded(double log_chance, Claim claim) {
  return log_chance < share_asked(claim) * kFalseClaim;
}

OwnStrengths own_strengths_in(const Studied& studied, const std::string& id) {
  OwnStrengths own;
  for (std::size_t i = 0; i < studied.fit.theta.size(); ++i) {
    const FreeNumber& number = studied.composition.numbers()[i];
    if (number.shot >= 0 && studied.composition.uses()[number.use].id() == id) {
      own.places.push_back(static_cast<Eigen::Index>(i));
    }
  }
  const Eigen::Map<const Eigen::VectorXd> theta(studied.fit.theta.data(),
                                                studied.fit.covariance.rows());
  own.found = theta(own.places);
  own.information = symmetric_inverse(studied.fit.covariance(own.places, own.places));
  return own;
}

std::optional<ProductTest> product_test_of(const Studied& studied, const std::string& id,
                                           const Campaign& campaign) {
  const EffectUse* use = studied.model.find(id);
  if (use == nullptr || !use->per_shot || !use->effect->about().each_gauge || use->alike) {
    return std::nullopt;
  }
  const OwnStrengths own = own_strengths_in(studied, id);
  return test_products(own.found, own.information, campaign.shots.size(), campaign.gauges());
}

}  // namespace kolsky
