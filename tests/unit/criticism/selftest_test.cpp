#include "processing/criticism/selftest/selftest.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "processing/base/error.hpp"
#include "processing/criticism/selftest/planting.hpp"
#include "processing/models/expression_effect.hpp"
#include "tests/generators/campaign.hpp"

namespace kolsky {
namespace {

std::vector<Shot> measured(std::uint64_t seed) {
  testing::CampaignWishes wishes{.seed = seed,
                                 .shots = 5,
                                 .tolerances = testing::Tolerances::none,
                                 .samples = 1536,
                                 .rate_Hz = 1e6};
  return testing::shots_of(testing::draw_campaign(wishes));
}

class Planting : public ::testing::Test {
 protected:
  Planting()
      : shots_(measured(91)),
        campaign_(read_campaign(shots_)),
        study_(campaign_, 0.0, Workers{}),
        studied_(study_.fit(paper_model(BenchKind::bar, false))),
        planter_(shots_, study_, studied_) {}

  /// Strain that was added to a record.
  std::vector<double> added(const std::vector<Shot>& after, std::size_t shot,
                            std::size_t gauge) const {
    const Campaign other = read_campaign(after);
    std::vector<double> difference = other.shots[shot].strain[gauge];
    for (std::size_t i = 0; i < difference.size(); ++i) {
      difference[i] -= campaign_.shots[shot].strain[gauge][i];
    }
    return difference;
  }

  std::vector<Shot> shots_;
  Campaign campaign_;
  Study study_;
  Studied studied_;
  Planter planter_;
};

TEST_F(Planting, OfAGaugeFactorAddsItsShareOfTheRecordAndTouchesNoOtherGauge) {
  EffectUse use = use_named("gauge-factor:g2");
  use.values[0].value = 0.03;
  const std::vector<Shot> after = planter_.planted(use);
  for (std::size_t n = 0; n < shots_.size(); ++n) {
    for (const std::size_t j : {0U, 2U}) {
      EXPECT_EQ(after[n].channels[j].codes, shots_[n].channels[j].codes);
    }
    const std::vector<double> more = added(after, n, 1);
    const std::vector<double>& strain = campaign_.shots[n].strain[1];
    double peak = 0.0;
    double product = 0.0;
    double square = 0.0;
    for (std::size_t i = 0; i < strain.size(); ++i) {
      peak = std::max(peak, std::abs(strain[i]));
      product += more[i] * strain[i];
      square += strain[i] * strain[i];
    }
    EXPECT_NEAR(product / square, 0.03, 3e-4);
    for (std::size_t i = 0; i < strain.size(); ++i) {
      ASSERT_NEAR(more[i], 0.03 * strain[i], 2e-3 * peak) << "sample " << i;
    }
  }
}

TEST_F(Planting, OfADelayMovesTheRecord) {
  EffectUse use = use_named("channel-delay:g2");
  const double late_s = 3.0 * campaign_.period_s;
  use.values[0].value = late_s;
  const std::vector<Shot> after = planter_.planted(use);
  const std::vector<double> more = added(after, 0, 1);
  const std::vector<double>& strain = campaign_.shots[0].strain[1];
  double missed = 0.0;
  double moved = 0.0;
  for (std::size_t i = 3; i < strain.size(); ++i) {
    const double expected = strain[i - 3] - strain[i];
    moved += expected * expected;
    missed += (more[i] - expected) * (more[i] - expected);
  }
  EXPECT_LT(missed, 0.05 * moved);
}

TEST_F(Planting, DrawsNoiseAnewAsItWasBeforeThePulses) {
  const std::vector<Shot> once = planter_.drawn_anew(7);
  const std::vector<Shot> again = planter_.drawn_anew(7);
  const std::vector<Shot> other = planter_.drawn_anew(8);
  EXPECT_EQ(once[0].channels[1].codes, again[0].channels[1].codes);
  EXPECT_NE(once[0].channels[1].codes, other[0].channels[1].codes);
  const auto power = [](const std::vector<Shot>& shots, std::size_t gauge) {
    const Campaign campaign = read_campaign(shots);
    double sum = 0.0;
    double count = 0.0;
    for (const CampaignShot& shot : campaign.shots) {
      for (std::size_t i = 0; i < shot.quiet_samples; ++i) {
        sum += shot.strain[gauge][i] * shot.strain[gauge][i];
        count += 1.0;
      }
    }
    return sum / count;
  };
  for (const std::size_t j : {0U, 1U}) {
    EXPECT_NEAR(power(once, j) / power(shots_, j), 1.0, 0.15);
  }
  const Campaign campaign = read_campaign(once);
  Study study(campaign, 0.0, Workers{});
  EXPECT_NEAR(study.fit(paper_model(BenchKind::bar, false)).misfit.chi2_reduced, 1.0, 0.1);
}

/// Gains as filed within 0.2 %, and one of them 2 % off: a fit strains the filed numbers.
std::vector<Shot> strained() {
  testing::CampaignWishes wishes{.seed = 94,
                                 .shots = 5,
                                 .tolerances = testing::Tolerances::none,
                                 .samples = 1536,
                                 .rate_Hz = 1e6};
  testing::Campaign campaign = testing::draw_campaign(wishes);
  testing::hide(campaign, testing::parse_effect("gauge-factor:g2=0.02"));
  std::vector<Shot> shots = testing::shots_of(campaign);
  for (Shot& shot : shots) {
    for (Gauge& gauge : shot.bench.gauges) {
      gauge.strain_gain = {1.0, 0.002};
    }
  }
  return shots;
}

// A null with a gauge ten of its deviations off would not be one.
TEST(DrawnAsFiled, HasTheMeanAndTheDeviationThatAreFiled) {
  const std::vector<Shot> shots = strained();
  const Campaign campaign = read_campaign(shots);
  Study study(campaign, 0.0, Workers{});
  const Studied studied = study.fit(paper_model(BenchKind::bar, false));
  const EffectUse* use = studied.model.find("gauge-factor:g2");
  ASSERT_NE(use, nullptr);
  ASSERT_GT(std::abs(use->values[0].value), 3.0 * 0.002);
  constexpr std::size_t kDraws = 400;
  std::size_t seen = 0;
  for (std::size_t i = 0; i < studied.fit.theta.size(); ++i) {
    const FreeNumber& number = studied.composition.numbers()[i];
    double mean = 0.0;
    double square = 0.0;
    for (std::uint64_t seed = 0; seed < kDraws; ++seed) {
      const double value = number.value_at(drawn_as_filed(studied, seed)[i]);
      mean += value / kDraws;
      square += value * value / kDraws;
    }
    if (number.prior_sd == 0.0) {
      EXPECT_NEAR(mean / number.value_at(studied.fit.theta[i]), 1.0, 1e-9);
      continue;
    }
    ++seen;
    EXPECT_NEAR(mean, 0.0, 4.0 * 0.002 / std::sqrt(static_cast<double>(kDraws)));
    EXPECT_NEAR(std::sqrt(square), 0.002, 0.15 * 0.002);
  }
  EXPECT_EQ(seen, campaign.gauges());
}

TEST(Selftest, ClaimsNothingOfNullsThoughTheModelStrainsTheFiledNumbers) {
  SelftestOptions options;
  options.effects = {"gauge-position:g3"};
  options.sizes = {5e-3};
  options.nulls = 2;
  const Selftest result =
      selftest(strained(), paper_model(BenchKind::bar, false), options, Workers{});
  EXPECT_EQ(result.untouched_effects, std::vector<std::string>{"gauge-factor:g2"});
  EXPECT_EQ(result.false_claims, 0U) << ::testing::PrintToString(result.falsely_claimed);
}

TEST(Selftest, FindsWhatWasPlantedLargeAndNothingFarBelowTheNoise) {
  SelftestOptions options;
  options.effects = {"gauge-position:g2"};
  options.sizes = {2e-5, 5e-3};
  options.nulls = 1;
  std::size_t last = 0;
  options.progress = [&](std::size_t done, std::size_t all) {
    EXPECT_LE(done, all);
    last = done;
  };
  const Selftest result =
      selftest(measured(92), paper_model(BenchKind::bar, false), options, Workers{});
  EXPECT_EQ(last, 4U);
  EXPECT_EQ(result.untouched, DiagnosisVerdict::adequate);
  EXPECT_EQ(result.nulls, 1U);
  EXPECT_EQ(result.false_claims, 0U);
  ASSERT_EQ(result.effects.size(), 1U);
  const PlantedEffect& effect = result.effects.front();
  ASSERT_EQ(effect.sizes.size(), 2U);
  EXPECT_EQ(effect.sizes[0].outcome, PlantOutcome::unseen);
  EXPECT_TRUE(effect.sizes[1].found())
      << name_of(effect.sizes[1].outcome) << " " << ::testing::PrintToString(effect.sizes[1].said);
  EXPECT_LT(std::abs(effect.sizes[1].strength - effect.sizes[1].size), 4.0 * effect.sizes[1].sd);
  EXPECT_EQ(effect.smallest_found(), 5e-3);
  EXPECT_GT(effect.identifiable, 2e-5);
  EXPECT_LT(effect.identifiable, 5e-3);
}

/// First order gave a hum's sizes in its prior's deviation and called them typical ones: a
/// hundredth of what can be found was planted.
TEST(Selftest, PlantsHumsOfSizesThatCanBeFound) {
  SelftestOptions options;
  options.effects = {"mains-hum"};
  options.multiples = {6.0};
  options.nulls = 0;
  const Selftest result =
      selftest(measured(92), paper_model(BenchKind::bar, false), options, Workers{});
  ASSERT_EQ(result.effects.size(), 1U);
  ASSERT_EQ(result.effects.front().sizes.size(), 1U);
  const PlantedSize& planted = result.effects.front().sizes.front();
  EXPECT_TRUE(planted.found()) << name_of(planted.outcome) << " of " << planted.size;
}

TEST(Selftest, PlantsBesideAnExpressionOfTheModelsOwn) {
  ExpressionText text{.id = "own-creep", .stage = Stage::sensor, .formula = "1 + c/(1 + s*tau)"};
  text.parameters = {{.name = "c", .unit = "-", .lower = -0.5, .upper = 0.5, .typical = 0.01},
                     {.name = "tau",
                      .unit = "s",
                      .lower = 1e-5,
                      .upper = 1e-1,
                      .typical = 1e-3,
                      .starts = {1e-3}}};
  Model model = paper_model(BenchKind::bar, false);
  model.expressions.push_back(std::make_shared<const ExpressionEffect>(text));
  SelftestOptions options;
  options.effects = {"gauge-position:g2", "own-creep:g2"};
  options.multiples = {6.0};
  options.nulls = 0;
  const Selftest result = selftest(measured(92), model, options, Workers{});
  ASSERT_EQ(result.effects.size(), 2U);
  for (const PlantedEffect& effect : result.effects) {
    ASSERT_EQ(effect.sizes.size(), 1U) << effect.id << effect.skipped;
    EXPECT_NE(effect.sizes.front().outcome, PlantOutcome::unseen) << effect.id;
  }
}

TEST(Selftest, RefusesWhatItCannotPlant) {
  const std::vector<Shot> shots = measured(93);
  const Model model = paper_model(BenchKind::bar, false);
  SelftestOptions options;
  options.effects = {"gauge-positions:g2"};
  EXPECT_THROW((void)selftest(shots, model, options, Workers{}), InputError);
  options.effects = {"gauge-position:g2"};
  for (const double size : {-1e-3, 1e3}) {
    options.sizes = {size};
    EXPECT_THROW((void)selftest(shots, model, options, Workers{}), InputError) << size;
  }
  Model holding = model;
  holding.effects.push_back(use_named("gauge-position:g2"));
  options.sizes = {1e-3};
  EXPECT_THROW((void)selftest(shots, holding, options, Workers{}), InputError);
}

TEST(PlantedEffect, IsFoundFromTheSizeAboveWhichNoneWasMissed) {
  PlantedEffect effect;
  const auto add = [&](double size, PlantOutcome outcome) {
    effect.sizes.push_back({size, 0.0, outcome, {}, 0.0, 0.0});
  };
  add(1.0, PlantOutcome::named);
  add(-2.0, PlantOutcome::wrong);
  add(4.0, PlantOutcome::tied);
  EXPECT_EQ(effect.smallest_found(), 4.0);
  add(8.0, PlantOutcome::unknown);
  EXPECT_TRUE(std::isinf(effect.smallest_found()));
}

}  // namespace
}  // namespace kolsky
