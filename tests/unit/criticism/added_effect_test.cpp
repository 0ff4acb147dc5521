// What a user adds by hand and fits: the campaign's generator works in time and has no part in it.
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "processing/criticism/fitting/study.hpp"
#include "tests/generators/campaign.hpp"

namespace kolsky {
namespace {

testing::CampaignWishes wishes(bool split) {
  testing::CampaignWishes wishes;
  wishes.seed = 5;
  wishes.shots = 3;
  wishes.gauges = split ? 3 : 4;
  wishes.noise_strain = 4e-6;
  wishes.split = split;
  return wishes;
}

struct Added {
  testing::Campaign truth;
  Studied studied;

  [[nodiscard]] const ModelValue& value(const std::string& id, std::size_t parameter) const {
    return studied.model.find(id)->values[parameter];
  }
  /// In its deviations.
  [[nodiscard]] double off(const std::string& id, std::size_t parameter, double true_value) const {
    const ModelValue& own = value(id, parameter);
    return std::abs(own.value - true_value) / own.sd;
  }
};

/// @param hidden  name and strength of each, all of which are added
Added fitted_with(bool split, const std::vector<std::pair<std::string, std::string>>& hidden) {
  testing::Campaign truth = testing::draw_campaign(wishes(split));
  Model model = paper_model(split ? BenchKind::shpb : BenchKind::bar, false);
  for (const auto& [name, strength] : hidden) {
    testing::hide(truth, testing::parse_effect(name + "=" + strength));
    model.effects.push_back(use_named(name));
  }
  const Campaign campaign = read_campaign(testing::shots_of(truth));
  Study study(campaign, 0.0, Workers{});
  return {std::move(truth), study.fit(model)};
}

class Gap : public ::testing::TestWithParam<double> {};

// Closing takes a few samples, less than the records' filter resolves.
TEST_P(Gap, IsFoundWithTheMaterialBehindIt) {
  const double gap_m = GetParam();
  const Added added = fitted_with(true, {{"interface-gap", std::to_string(1e6 * gap_m) + "e-6"}});
  EXPECT_LT(added.off("interface-gap", 0, gap_m), 3.0);
  EXPECT_LT(added.value("interface-gap", 0).sd, 0.5e-6);
  const testing::TrueSpecimen& specimen = added.truth.split->specimen;
  EXPECT_LT(added.off("three-element-specimen", 0, specimen.E1_Pa), 3.0);
  EXPECT_LT(added.off("three-element-specimen", 1, specimen.E2_Pa), 3.0);
  EXPECT_LT(added.off("three-element-specimen", 2, specimen.eta2_Pa_s), 3.0);
  EXPECT_LT(added.studied.misfit.chi2_reduced, 1.1);
}

INSTANTIATE_TEST_SUITE_P(Sizes, Gap, ::testing::Values(3e-6, 10e-6, 20e-6));

TEST(Added, CrosstalkTakesTheNeighbourThatItFits) {
  for (const auto* from : {"2", "4"}) {
    const Added added = fitted_with(false, {{"crosstalk:g3", std::string("0.02,from=") + from}});
    EXPECT_LT(added.off("crosstalk:g3", 0, 0.02), 3.0) << from;
    EXPECT_EQ(added.value("crosstalk:g3", 1).value, from[0] == '2' ? -1.0 : 1.0);
    EXPECT_FALSE(added.value("crosstalk:g3", 1).free);
  }
}

// Half the shortest wave judged is 40 mm here: the gauge is blind to some of what is judged.
TEST(Added, ALengthOfTheReferenceGaugeIsFoundPastItsBlindFrequency) {
  const Campaign bare = read_campaign(testing::shots_of(testing::draw_campaign(wishes(false))));
  const std::string id = "gauge-length:" + bare.bench.gauges[bare.reference].name;
  for (const double length_m : {0.02, 0.05, 0.08}) {
    const Added added = fitted_with(false, {{id, std::to_string(length_m)}});
    EXPECT_LT(added.off(id, 0, length_m), 3.0) << length_m;
    EXPECT_LT(added.value(id, 0).sd, 0.05 * length_m) << length_m;
    EXPECT_LT(added.studied.misfit.chi2_reduced, 1.1) << length_m;
    const testing::TrueMaterial& bar = added.truth.world.material;
    EXPECT_LT(added.off("three-element-bar", 0, bar.E1_Pa), 3.0) << length_m;
    EXPECT_LT(added.off("three-element-bar", 1, bar.E2_Pa), 3.0) << length_m;
  }
}

// A spring that gives way strains the specimen further, and what is strained further is moved
// sideways further, too.
TEST(Added, LateralInertiaOfASpecimenThatSoftens) {
  const Added added = fitted_with(true, {{"radial-inertia", "8"}, {"specimen-nonlinearity", "-6"}});
  EXPECT_LT(added.off("radial-inertia", 0, 8.0), 3.0);
  EXPECT_LT(added.off("specimen-nonlinearity", 0, -6.0), 3.0);
  const testing::TrueSpecimen& specimen = added.truth.split->specimen;
  EXPECT_LT(added.off("three-element-specimen", 0, specimen.E1_Pa), 3.0);
  EXPECT_LT(added.studied.misfit.chi2_reduced, 1.1);
}

}  // namespace
}  // namespace kolsky
