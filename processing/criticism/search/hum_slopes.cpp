#include "processing/criticism/search/hum_slopes.hpp"

#include <array>

#include "processing/algebra/algebra.hpp"
#include "processing/criticism/search/own_strengths.hpp"
#include "processing/criticism/search/product_test.hpp"

namespace kolsky {

namespace {

/// Slopes of a hum's cosine and sine part of unit strength before a shot's pulse.
std::array<double, 2> unit_slopes(const EffectUse& use, const Campaign& campaign,
                                  const CampaignShot& shot) {
  std::vector<double> values;
  for (const ModelValue& value : use.values) {
    values.push_back(value.value);
  }
  std::array<double, 2> slopes{};
  for (std::size_t part = 0; part < slopes.size(); ++part) {
    values[0] = part == 0 ? 1.0 : 0.0;
    values[1] = 1.0 - values[0];
    Scene scene(campaign.bench, shot.facts, {});
    scene.record.additions.resize(campaign.gauges());
    use.effect->apply(scene, values, 0);
    slopes[part] = slope_before(shot, scene.record.additions[0]);
  }
  return slopes;
}

/// Slopes, by shot and then by gauge, of strengths as a fit has them.
Eigen::MatrixXd slopes_by_strengths(const Studied& studied, const EffectUse& use,
                                    const Campaign& campaign,
                                    const std::vector<Eigen::Index>& own) {
  const auto gauges = static_cast<Eigen::Index>(campaign.gauges());
  const auto shots = static_cast<Eigen::Index>(campaign.shots.size());
  Eigen::MatrixXd slopes =
      Eigen::MatrixXd::Zero(shots * gauges, static_cast<Eigen::Index>(own.size()));
  for (Eigen::Index n = 0; n < shots; ++n) {
    const auto of_parts = unit_slopes(use, campaign, campaign.shots[static_cast<std::size_t>(n)]);
    for (Eigen::Index j = 0; j < gauges; ++j) {
      for (Eigen::Index part = 0; part < 2; ++part) {
        const Eigen::Index column = (part * shots + n) * gauges + j;
        const auto number = static_cast<std::size_t>(own[static_cast<std::size_t>(column)]);
        slopes(n * gauges + j, column) =
            studied.composition.numbers()[number].scale * of_parts[static_cast<std::size_t>(part)];
      }
    }
  }
  return slopes;
}

}  // namespace

SlopesByShot slopes_of_products(const Studied& studied, const std::string& id,
                                const Campaign& campaign, const SlopesByShot& of_others) {
  const OwnStrengths own = own_strengths_in(studied, id);
  const Eigen::MatrixXd slopes =
      slopes_by_strengths(studied, *studied.model.find(id), campaign, own.places);
  const SlopesByShot variances = variances_of_slopes(campaign);
  const std::size_t gauges = campaign.gauges();
  Eigen::VectorXd before(slopes.rows());
  Eigen::VectorXd weight(slopes.rows());
  for (std::size_t n = 0; n < campaign.shots.size(); ++n) {
    const CampaignShot& shot = campaign.shots[n];
    for (std::size_t j = 0; j < gauges; ++j) {
      const auto at = static_cast<Eigen::Index>(n * gauges + j);
      before[at] = slope_before(shot, shot.strain[j]) - of_others[n][j];
      weight[at] = variances[n][j] > 0.0 ? 1.0 / variances[n][j] : 0.0;
    }
  }
  const Eigen::MatrixXd of_quiet = slopes.transpose() * weight.asDiagonal();
  const Eigen::MatrixXd of_both = own.information + of_quiet * slopes;
  const Eigen::VectorXd strengths =
      solve_symmetric(of_both, own.information * own.found + of_quiet * before);
  const Eigen::VectorXd products =
      slopes * nearest_products(strengths, of_both, campaign.shots.size(), gauges).strengths;
  SlopesByShot list;
  for (std::size_t n = 0; n < campaign.shots.size(); ++n) {
    const double* first = products.data() + n * gauges;
    list.emplace_back(first, first + gauges);
  }
  return list;
}

}  // namespace kolsky
