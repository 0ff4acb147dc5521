// Where fits of a specimen's moduli begin, and how far they go: the campaign's generator works in
// time and has no part in it.
#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "processing/criticism/fitting/study.hpp"
#include "tests/generators/campaign.hpp"
#include "tests/unit/criticism/filed_bars.hpp"

namespace kolsky {
namespace {

/// A plastic that relaxes little: a spring with a branch many times as stiff.
testing::Campaign of_little_loss(double stiffness_ratio, double time_s) {
  testing::Campaign truth = testing::draw_campaign(
      {.seed = 12, .shots = 4, .gauges = 3, .noise_strain = 2e-6, .split = true});
  testing::TrueSpecimen& specimen = truth.split->specimen;
  specimen.E1_Pa = 800e6;
  specimen.E2_Pa = stiffness_ratio * specimen.E1_Pa;
  specimen.eta2_Pa_s = time_s * specimen.E2_Pa;
  return truth;
}

class LittleLoss : public ::testing::TestWithParam<std::array<double, 2>> {};

// From a branch as stiff as the spring fits ended in a valley where both grow and its time falls.
TEST_P(LittleLoss, IsFoundFromWhereModelsBegin) {
  const testing::Campaign truth = of_little_loss(GetParam()[0], GetParam()[1]);
  const testing::TrueSpecimen& specimen = truth.split->specimen;
  const Campaign campaign = read_campaign(testing::shots_of(truth));
  Study study(campaign, 0.0, Workers{});
  const Studied studied = study.fit(filed_split_bar(truth));
  EXPECT_LT(studied.misfit.chi2_reduced, 1.1);
  const EffectUse& found = *studied.model.find("three-element-specimen");
  const std::array true_values{specimen.E1_Pa, specimen.E2_Pa, specimen.eta2_Pa_s};
  EXPECT_LT(found.values[0].sd, 0.01 * specimen.E1_Pa);
  for (std::size_t p = 0; p < true_values.size(); ++p) {
    const ModelValue& own = found.values[p];
    EXPECT_LT(std::abs(own.value - true_values[p]), 3.0 * own.sd)
        << p << ": " << own.value << " +- " << own.sd << " of " << true_values[p];
  }
}

INSTANTIATE_TEST_SUITE_P(OfAPlastic, LittleLoss,
                         ::testing::Values(std::array{100.0, 40e-6}, std::array{100.0, 120e-6},
                                           std::array{30.0, 40e-6}, std::array{60.0, 20e-6}));

}  // namespace
}  // namespace kolsky
