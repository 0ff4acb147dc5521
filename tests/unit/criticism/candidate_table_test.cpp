#include "processing/criticism/search/candidate_table.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "processing/criticism/search/search.hpp"
#include "processing/criticism/verdict/claims.hpp"
#include "tests/generators/campaign.hpp"

namespace kolsky {
namespace {

/// Each seed is another bench with another material.
testing::CampaignWishes bar(std::uint64_t seed) {
  return {.seed = seed, .shots = 4, .gauges = 3, .samples = 1500, .rate_Hz = 1e6};
}

testing::CampaignWishes split_bar(std::uint64_t seed) {
  testing::CampaignWishes wishes = bar(seed);
  wishes.split = true;
  wishes.elastic = true;
  wishes.gauges = 2;
  return wishes;
}

/// What a first search says of every effect.
std::vector<CandidateResult> searched(const testing::CampaignWishes& wishes,
                                      const std::string& hidden) {
  testing::Campaign truth = testing::draw_campaign(wishes);
  if (!hidden.empty()) {
    testing::hide(truth, testing::parse_effect(hidden));
  }
  const Campaign campaign = read_campaign(testing::shots_of(truth));
  Study study(campaign, 0.0, Workers{});
  const Model model = paper_model(wishes.split ? BenchKind::shpb : BenchKind::bar, wishes.elastic);
  const Studied base = study.fit(model);
  Search search(study, base, model);
  return first_order_table(
      {search.candidates(), search.directions(), base, search.log_trials(), 1.0, search.known()});
}

double own_p(const std::vector<CandidateResult>& table, const std::string& id) {
  const auto own = std::find_if(table.begin(), table.end(),
                                [&](const CandidateResult& result) { return result.effect == id; });
  return std::exp(own->own_log_p);
}

// A number lies d off what is filed with deviation p, and the records know it to r: d^2 / (p^2 +
// r^2) is gained where it is set free, and d^2 / (p^2 + s r^2) where squares of the records count
// over s.
TEST(DoubtOfGain, IsOfTheRecordsPartAlone) {
  constexpr double kDoubt = 6.0;
  Candidate filed;
  filed.frees_prior = true;
  for (const double r_over_p : {0.01, 0.5, 1.0, 3.0}) {
    const double square = r_over_p * r_over_p;
    Direction direction;
    direction.information = Eigen::MatrixXd::Constant(1, 1, 1.0 / (1.0 + square));
    EXPECT_NEAR(doubt_of_gain(filed, direction, kDoubt), (1.0 + kDoubt * square) / (1.0 + square),
                1e-12);
    EXPECT_EQ(doubt_of_gain(Candidate{}, direction, kDoubt), kDoubt);
  }
}

// A program that reads the rows finds numbers in all of them: of what is fitted away, what its
// bounds leave.
TEST(CandidateTable, StatesAnUntestableStrengthByItsBounds) {
  int untestable = 0;
  for (const CandidateResult& result : searched(bar(501), "")) {
    EXPECT_TRUE(std::isfinite(result.strength)) << result.effect;
    EXPECT_TRUE(std::isfinite(result.sd)) << result.effect;
    if (result.verdict == CandidateVerdict::untestable) {
      ++untestable;
      EXPECT_EQ(result.own_log_p, 0.0) << result.effect;
      EXPECT_GT(result.sd, std::abs(result.strength)) << result.effect;
    }
  }
  EXPECT_GT(untestable, 0);
}

// First order finds some effects only at sizes that nothing has: 6400 m of a bar's length.
TEST(CandidateTable, StatesNoSizeThatAStrengthCannotHave) {
  int beyond = 0;
  for (const CandidateResult& result : searched(bar(501), "")) {
    const EffectParameter& own = use_named(result.effect).effect->about().parameters.front();
    const double reach = std::max(own.upper - own.null_value, own.null_value - own.lower);
    for (const double size : {result.detectable, result.identifiable}) {
      EXPECT_TRUE(std::isinf(size) || size <= reach) << result.effect << " " << size;
    }
    beyond += std::isfinite(result.detectable) && std::isinf(result.identifiable) ? 1 : 0;
  }
  EXPECT_GT(beyond, 0);
}

// A specimen's length and diameter together are nearly its stiffness, which is fitted: the line of
// first order led to 792 m on measured shots, at a gain that no dimension in reach has.
TEST(CandidateTable, KeepsSeveralStrengthsWithinTheirBoundsTogether) {
  constexpr double kLargestBound_m = 5e-3;
  constexpr double kGain = 100.0;
  const testing::Campaign truth = testing::draw_campaign(split_bar(521));
  const Campaign campaign = read_campaign(testing::shots_of(truth));
  Study study(campaign, 0.0, Workers{});
  const Model model = paper_model(BenchKind::shpb, true);
  const Studied base = study.fit(model);
  const Search search(study, base, model);
  std::vector<Direction> directions = search.directions();
  for (std::size_t i = 0; i < directions.size(); ++i) {
    if (search.candidates()[i].id() == "specimen-dimensions") {
      directions[i].step *= 1e6 / directions[i].step.norm();
      directions[i].gain = kGain;
    }
  }
  const auto table =
      first_order_table({search.candidates(), directions, base, search.log_trials(), 1.0});
  const auto own = std::find_if(table.begin(), table.end(), [](const CandidateResult& result) {
    return result.effect == "specimen-dimensions";
  });
  ASSERT_NE(own, table.end());
  EXPECT_LE(std::abs(own->strength), kLargestBound_m);
  EXPECT_LT(own->gain, 0.1 * kGain);
}

// Of one bench they hang together, so the bounds are those of some thirty independent numbers.
TEST(CandidateTable, AnEffectsOwnChanceIsUniformWhereNothingIsHidden) {
  std::vector<double> chances;
  double most_one_sided = 0.0;
  for (std::uint64_t seed = 501; seed < 517; ++seed) {
    const auto table = searched(bar(seed), "");
    for (const char* id : {"gauge-factor:g2", "gauge-position:g3", "crosstalk:g2"}) {
      chances.push_back(own_p(table, id));
    }
    most_one_sided = std::max(most_one_sided, own_p(table, "geometric-dispersion"));
    for (const CandidateResult& result : table) {
      EXPECT_LE(result.own_log_p, 0.0) << result.effect;
      EXPECT_LE(result.own_log_p, result.log_p + 1e-9) << result.effect;
    }
  }
  const auto share_below = [&](double limit) {
    return static_cast<double>(std::count_if(chances.begin(), chances.end(),
                                             [&](double chance) { return chance < limit; })) /
           static_cast<double>(chances.size());
  };
  EXPECT_NEAR(share_below(0.5), 0.5, 0.27);
  EXPECT_NEAR(share_below(0.25), 0.25, 0.24);
  EXPECT_GT(*std::min_element(chances.begin(), chances.end()), 1e-4);
  // What can have one sign only is likely on noise that asks for the other.
  EXPECT_GT(most_one_sided, 0.6);
}

TEST(CandidateTable, AnEffectsOwnChanceIsSmallWhereItIs) {
  EXPECT_LT(own_p(searched(bar(501), "gauge-factor:g2=0.02"), "gauge-factor:g2"), 1e-6);
}

// What first order foretold is no more than a foretelling.
TEST(Claims, AreDetectableAtTheSizeThatTheyWereFoundAt) {
  for (const bool tied : {false, true}) {
    Diagnosis diagnosis;
    diagnosis.effects = {"bending"};
    if (tied) {
      diagnosis.tied_with["bending"] = {"crosstalk:g1"};
    }
    CandidateResult found;
    found.effect = "bending";
    found.parameter = "chi";
    found.strength = -1.0;
    found.detectable = 2.0;
    found.identifiable = 3.0;
    diagnosis.candidates = {found};
    Model model = paper_model(BenchKind::bar, false);
    model.effects.push_back(use_named("bending"));
    settle_claims(diagnosis, model, [](CandidateResult&) {});
    EXPECT_EQ(diagnosis.candidates[0].detectable, 1.0);
    EXPECT_EQ(diagnosis.candidates[0].identifiable, tied ? 3.0 : 1.0);
  }
}

// Where nothing is hidden a fractional order is 1, and of an end's return what is told is how much
// of a wave comes back of one that was not there.
TEST(Claims, AreAsLargeAsTheyAreOffWhereNothingIsHidden) {
  const auto settled = [](const std::string& id, const std::string& parameter, double strength) {
    CandidateResult found;
    found.effect = id;
    found.parameter = parameter;
    found.strength = strength;
    found.detectable = found.identifiable = 0.5;
    Diagnosis diagnosis;
    diagnosis.effects = {id};
    diagnosis.candidates = {found};
    Model model = paper_model(BenchKind::bar, false);
    model.effects.push_back(use_named(id));
    settle_claims(diagnosis, model, [](CandidateResult&) {});
    return diagnosis.candidates[0].detectable;
  };
  EXPECT_NEAR(settled("fractional-damping", "beta", 0.98), 0.02, 1e-12);
  EXPECT_EQ(settled("end-reflection", "r", 0.0), 0.5);
}

}  // namespace
}  // namespace kolsky
