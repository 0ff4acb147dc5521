// A user knows better than the library how far a number can go: a fit keeps within that.
#include <gtest/gtest.h>

#include <array>
#include <random>
#include <vector>

#include "processing/criticism/fitting/study.hpp"
#include "tests/generators/campaign.hpp"

namespace kolsky {
namespace {

TEST(Bounds, OfAModelAreWhereItsFitEnds) {
  testing::CampaignWishes wishes{
      .seed = 12, .shots = 3, .gauges = 3, .samples = 1500, .rate_Hz = 1e6};
  const testing::Campaign truth = testing::draw_campaign(wishes);
  const Campaign campaign = read_campaign(testing::shots_of(truth));
  Study study(campaign, 0.0, Workers{});
  const double E1_Pa = truth.world.material.E1_Pa;

  Model model = paper_model(BenchKind::bar, false);
  ModelValue& E1 = model.find("three-element-bar")->values[0];
  E1.value = 1.03 * E1_Pa;
  E1.bounds = std::array{1.02 * E1_Pa, 1.05 * E1_Pa};
  EXPECT_DOUBLE_EQ(study.fit(model).model.effects[0].values[0].value, 1.02 * E1_Pa);

  E1.bounds = std::array{0.9 * E1_Pa, 1.05 * E1_Pa};
  EXPECT_NEAR(study.fit(model).model.effects[0].values[0].value, E1_Pa, 0.003 * E1_Pa);
}

/// With noise that all gauges share, as of one supply, besides their own.
std::vector<Shot> shots_on_one_supply(std::uint64_t seed) {
  const testing::Campaign truth = testing::draw_campaign(
      {.seed = seed, .shots = 3, .gauges = 3, .samples = 1500, .rate_Hz = 1e6});
  testing::CampaignForward forward;
  testing::Readings readings = forward.readings(truth);
  std::mt19937_64 random(seed);
  std::normal_distribution<double> shared(0.0, 4e-6);
  for (auto& shot : readings) {
    for (std::size_t n = 0; n < shot.front().size(); ++n) {
      const double strain = shared(random);
      for (std::vector<double>& gauge : shot) {
        gauge[n] += strain;
      }
    }
  }
  return testing::shots_of(truth, readings);
}

// A gauge with a length holds less of what is carried to the others; one of next to nothing as much
// as one of none. (A step there, of a thousandth of the noise, stood for 19 deviations of length.)
TEST(GaugeLength, OfNextToNothingIsNone) {
  const Campaign campaign = read_campaign(shots_on_one_supply(13));
  Study study(campaign, 0.0, Workers{});
  const Studied base = study.fit(paper_model(BenchKind::bar, false));
  Model model = base.model;
  model.effects.push_back(
      use_named("gauge-length:" + campaign.bench.gauges[campaign.reference].name));
  const auto residuals = [&](double length_m) {
    model.effects.back().values[0].value = length_m;
    const Composition composition(model, campaign);
    return study.residuals().evaluate(composition, composition.start(), 0);
  };
  EXPECT_LT((residuals(1e-5) - residuals(0.0)).norm(), 1e-3);
  EXPECT_GT((residuals(1e-2) - residuals(0.0)).norm(), 1.0);
}

}  // namespace
}  // namespace kolsky
