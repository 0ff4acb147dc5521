// Noise that wanders slowly and alike at all gauges, another way in every shot: in records of a
// fraction of the mains' period nearly all of it is a slope, as of a hum.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "processing/criticism/search/own_strengths.hpp"
#include "processing/criticism/verdict/diagnosis.hpp"
#include "tests/generators/campaign.hpp"
#include "tests/unit/criticism/filed_bars.hpp"

namespace kolsky {
namespace {

testing::Campaign six_shots(std::uint64_t seed) {
  testing::CampaignWishes wishes{
      .seed = seed, .shots = 6, .gauges = 3, .samples = 2048, .rate_Hz = 1e6};
  return testing::draw_campaign(wishes);
}

Diagnosis diagnosed(const std::vector<Shot>& shots) {
  const Campaign campaign = read_campaign(shots);
  Study study(campaign, 0.0, Workers{});
  return diagnose(study, paper_model(BenchKind::bar, false), {});
}

/// 150 to 700 Hz, as strong as the gauges' own noise.
testing::Readings wandering(const testing::Campaign& campaign, std::uint64_t seed) {
  testing::CampaignForward forward;
  testing::Readings readings = forward.readings(campaign);
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> even;
  constexpr double kAmplitude = 6e-6;
  for (auto& shot : readings) {
    const double per_sample = 2.0 * std::numbers::pi * (150.0 + 550.0 * even(random)) * 1e-6;
    const double phase = 2.0 * std::numbers::pi * even(random);
    for (std::vector<double>& gauge : shot) {
      for (std::size_t n = 0; n < gauge.size(); ++n) {
        gauge[n] += kAmplitude * std::cos(per_sample * static_cast<double>(n) + phase);
      }
    }
  }
  return readings;
}

// Of these eight one is a hum to all that can be seen of it.
TEST(CommonWander, IsNoHum) {
  std::size_t claimed = 0;
  for (std::uint64_t seed = 601; seed < 609; ++seed) {
    const testing::Campaign campaign = six_shots(seed);
    const Diagnosis diagnosis = diagnosed(testing::shots_of(campaign, wandering(campaign, seed)));
    claimed += diagnosis.effects.empty() ? 0 : 1;
  }
  EXPECT_LE(claimed, 1U);
}

// Nor does what keeps wander from being one keep a hum from being found. Records of a tenth of a
// period do not know whether it is of 50 or 60 Hz, by which amplitudes differ by a third.
TEST(CommonWander, LeavesAHumWhatItIs) {
  constexpr double kAmplitude = 4e-5;
  std::size_t found = 0;
  for (std::uint64_t seed = 601; seed < 609; ++seed) {
    testing::Campaign campaign = six_shots(seed);
    const char* frequency = seed % 2 == 0 ? "50" : "60";
    testing::hide(campaign,
                  testing::parse_effect(std::string("mains-hum=4e-5,frequency=") + frequency));
    const Diagnosis diagnosis = diagnosed(testing::shots_of(campaign));
    if (diagnosis.effects != std::vector<std::string>{"mains-hum"}) {
      continue;
    }
    ++found;
    const auto hum = std::ranges::find(diagnosis.candidates, "mains-hum", &CandidateResult::effect);
    ASSERT_NE(hum, diagnosis.candidates.end());
    EXPECT_LT(std::abs(hum->strength - kAmplitude), 2.5 * hum->sd) << seed << ": " << hum->strength;
    EXPECT_LT(hum->sd, 0.6 * kAmplitude) << seed;
  }
  EXPECT_GE(found, 7U);
}

testing::Campaign split_bars(std::uint64_t seed) {
  return testing::draw_campaign(
      {.seed = seed, .shots = 8, .gauges = 2, .noise_strain = 3e-6, .split = true});
}

Diagnosis diagnosed(const testing::Campaign& truth, const std::vector<Shot>& shots) {
  const Campaign campaign = read_campaign(shots);
  Study study(campaign, 0.0, Workers{});
  const Model plain = paper_model(truth.split ? BenchKind::shpb : BenchKind::bar,
                                  truth.split || truth.wishes.elastic);
  return diagnose(study, truth.filed_bars ? filed_split_bar(truth) : plain, {});
}

bool says(const Diagnosis& diagnosis, const std::string& id) {
  return std::ranges::any_of(diagnosis.effects, [&](const std::string& own) {
    const auto ties = diagnosis.tied_with.find(own);
    return own == id ||
           (ties != diagnosis.tied_with.end() && std::ranges::count(ties->second, id) > 0);
  });
}

bool says_hum(const Diagnosis& diagnosis) {
  return says(diagnosis, "mains-hum");
}

// Its phase is another in every shot, so that it does not repeat; a fit that takes for noise what
// does not repeat takes the hum for noise, and finds half as many of these.
TEST(MainsHum, OfFourTimesWhiteNoiseIsFoundOnSplitBars) {
  std::size_t found = 0;
  for (std::uint64_t seed = 21; seed < 29; ++seed) {
    testing::Campaign campaign = split_bars(seed);
    testing::hide(campaign, testing::parse_effect("mains-hum=12e-6"));
    const Diagnosis diagnosis = diagnosed(campaign, testing::shots_of(campaign));
    found += says_hum(diagnosis) ? 1 : 0;
    EXPECT_LE(diagnosis.effects.size(), 1U) << seed;
    EXPECT_TRUE(diagnosis.effects.empty() || says_hum(diagnosis)) << seed;
  }
  EXPECT_GE(found, 6U);
}

testing::Campaign elastic_bar(std::uint64_t seed, int shots, int gauges, double noise_strain) {
  testing::CampaignWishes wishes{
      .seed = seed, .shots = shots, .gauges = gauges, .noise_strain = noise_strain};
  wishes.samples = 2048;
  wishes.rate_Hz = 1e6;
  wishes.elastic = true;
  return testing::draw_campaign(wishes);
}

Diagnosis diagnosed_elastic(const std::vector<Shot>& shots) {
  const Campaign campaign = read_campaign(shots);
  Study study(campaign, 0.0, Workers{});
  return diagnose(study, paper_model(BenchKind::bar, true), {});
}

// In records of a tenth of a period what one gauge picks up is a slope of its own in every shot.
TEST(MainsHum, OfOneGaugeIsNoDriftByItself) {
  int claimed = 0;
  for (std::uint64_t seed = 41; seed < 45; ++seed) {
    testing::Campaign campaign = elastic_bar(seed, 5, 2, 1.5e-6);
    testing::hide(campaign, testing::parse_effect("mains-hum=20e-6"));
    campaign.world.hum.share = {0.0, 1.0};
    const Diagnosis diagnosis = diagnosed_elastic(testing::shots_of(campaign));
    claimed += diagnosis.effects.empty() ? 0 : 1;
    EXPECT_TRUE(diagnosis.effects.empty() || says_hum(diagnosis)) << seed;
  }
  EXPECT_GE(claimed, 3);
}

/// Another slope in every shot and at each of these gauges.
testing::Readings sloping(const testing::Campaign& campaign, const std::vector<std::size_t>& gauges,
                          std::uint64_t seed) {
  constexpr double kSlope_per_s = 0.012;
  testing::CampaignForward forward;
  testing::Readings readings = forward.readings(campaign);
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  for (auto& shot : readings) {
    for (const std::size_t gauge : gauges) {
      const double per_sample = kSlope_per_s * normal(random) * campaign.world.timing.period_s();
      for (std::size_t n = 0; n < shot[gauge].size(); ++n) {
        shot[gauge][n] += per_sample * static_cast<double>(n);
      }
    }
  }
  return readings;
}

// What is left beside the drift of one gauge is that of the other: taken for slow noise, each hid
// the other, and both were found in one of these.
TEST(Drifts, OfTwoGaugesAreFoundBesideEachOther) {
  int found = 0;
  for (const std::uint64_t seed : {52U, 53U, 54U, 56U}) {
    const testing::Campaign campaign = elastic_bar(seed, 7, 4, 5e-6);
    const Diagnosis diagnosis =
        diagnosed_elastic(testing::shots_of(campaign, sloping(campaign, {0, 2}, seed)));
    EXPECT_TRUE(diagnosis.effects.empty() || says(diagnosis, "baseline-drift:g1") ||
                says(diagnosis, "baseline-drift:g3"))
        << seed;
    found += says(diagnosis, "baseline-drift:g1") && says(diagnosis, "baseline-drift:g3") ? 1 : 0;
  }
  EXPECT_GE(found, 3);
}

/// Random walks that reach six times the white noise by the records' ends.
testing::Readings walking(const testing::Campaign& campaign, std::uint64_t seed, bool common) {
  testing::CampaignForward forward;
  testing::Readings readings = forward.readings(campaign);
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  for (auto& shot : readings) {
    const double step = 18e-6 / std::sqrt(static_cast<double>(shot.front().size()));
    std::vector<double> at(shot.size(), 0.0);
    for (std::size_t n = 0; n < shot.front().size(); ++n) {
      const double of_all = step * normal(random);
      for (std::size_t j = 0; j < shot.size(); ++j) {
        at[j] += common ? of_all : step * normal(random);
        shot[j][n] += at[j];
      }
    }
  }
  return readings;
}

// They slope as a hum does, and turn besides.
TEST(RandomWalk, IsNeitherHumNorDrift) {
  std::size_t claimed = 0;
  for (const bool common : {false, true}) {
    for (std::uint64_t seed = 31; seed < 35; ++seed) {
      const testing::Campaign campaign = split_bars(seed);
      const Diagnosis diagnosis =
          diagnosed(campaign, testing::shots_of(campaign, walking(campaign, seed, common)));
      claimed += diagnosis.effects.empty() ? 0 : 1;
    }
  }
  EXPECT_EQ(claimed, 0U);
}

testing::Campaign three_gauges(std::uint64_t seed) {
  return testing::draw_campaign({.seed = seed,
                                 .shots = 8,
                                 .gauges = 3,
                                 .noise_strain = 3.3e-6,
                                 .samples = 4000,
                                 .rate_Hz = 1e6});
}

// Of three gauges there are two differences to a slope each, of which products of any shares
// explain nine tenths by chance: by that alone hardly one of these was more than noise.
TEST(MainsHum, InSharesOfThreeGaugesIsNamed) {
  std::size_t found = 0;
  for (std::uint64_t seed = 701; seed < 705; ++seed) {
    testing::Campaign campaign = three_gauges(seed);
    testing::hide(campaign, testing::parse_effect("mains-hum=2.3e-5"));
    campaign.world.hum.share = {-0.75, 0.74, -0.83};
    const Diagnosis diagnosis = diagnosed(testing::shots_of(campaign));
    found += diagnosis.effects == std::vector<std::string>{"mains-hum"} ? 1 : 0;
  }
  EXPECT_GE(found, 3U);
}

/// Bars with a hum that gauges pick up in such shares.
testing::Campaign humming(testing::CampaignWishes wishes, const char* effect,
                          const std::vector<double>& share) {
  testing::Campaign campaign = testing::draw_campaign(wishes);
  testing::hide(campaign, testing::parse_effect(effect));
  campaign.world.hum.share = share;
  return campaign;
}

// All gauges have most of it alike, by which it is found first. The rest slopes at one of them, and
// was named a drift in all of these.
TEST(MainsHum, InUnequalSharesLeavesNoDriftToTheGaugeWithMost) {
  for (const std::uint64_t seed : {772U, 774U, 777U, 781U}) {
    const testing::Campaign campaign = humming({.seed = seed,
                                                .shots = 6,
                                                .gauges = 3,
                                                .noise_strain = 4.6e-6,
                                                .samples = 1500,
                                                .rate_Hz = 1e6,
                                                .split = seed % 2 == 0,
                                                .elastic = seed % 3 == 0},
                                               "mains-hum=5e-5", {1.03, 1.02, 1.26});
    const Diagnosis diagnosis = diagnosed(campaign, testing::shots_of(campaign));
    EXPECT_EQ(diagnosis.effects, std::vector<std::string>{"mains-hum"}) << seed;
  }
}

// A drift beside a hum that gauges do have alike is one.
TEST(Drifts, BesideAHumThatIsAlikeStay) {
  std::size_t found = 0;
  for (std::uint64_t seed = 750; seed < 754; ++seed) {
    testing::Campaign campaign = humming({.seed = seed,
                                          .shots = 6,
                                          .gauges = 4,
                                          .noise_strain = 3e-6,
                                          .samples = 2000,
                                          .rate_Hz = 1e6},
                                         "mains-hum=6e-5", {1.0, 1.0, 1.0, 1.0});
    testing::hide(campaign, testing::parse_effect("baseline-drift:g2=0.01"));
    const Diagnosis diagnosis = diagnosed(testing::shots_of(campaign));
    found += says(diagnosis, "mains-hum") && says(diagnosis, "baseline-drift:g2") ? 1 : 0;
  }
  EXPECT_GE(found, 3U);
}

// What the records do not know of its shares, for the source takes it up, was taken for wander.
TEST(MainsHum, InSharesOfGaugesOnSplitBarsIsNamed) {
  for (const std::uint64_t seed : {792U, 796U, 797U}) {
    const testing::Campaign campaign = humming({.seed = seed,
                                                .shots = 8,
                                                .gauges = 5,
                                                .noise_strain = 4.8e-6,
                                                .samples = 1250,
                                                .rate_Hz = 5e5,
                                                .split = true,
                                                .elastic = true},
                                               "mains-hum=4e-5", {0.68, 1.04, 0.7, 0.54, 1.01});
    const Diagnosis diagnosis = diagnosed(campaign, testing::shots_of(campaign));
    EXPECT_EQ(diagnosis.effects, std::vector<std::string>{"mains-hum"}) << seed;
  }
}

// Drifts are found of this hum and let go again. The noise that was learned meanwhile is that of
// both misfits: before was less than after, of one model.
TEST(Misfit, IsOneWhereWhatWasFoundIsLetGo) {
  testing::CampaignWishes wishes{
      .seed = 736, .shots = 6, .gauges = 4, .noise_strain = 2e-6, .samples = 2000, .rate_Hz = 1e6};
  testing::Campaign campaign = testing::draw_campaign(wishes);
  testing::hide(campaign, testing::parse_effect("mains-hum=9e-6"));
  campaign.world.hum.share = {1.0, 0.7, 1.2, 0.4};
  const Diagnosis diagnosis = diagnosed(testing::shots_of(campaign));
  if (!diagnosis.effects.empty()) {
    GTEST_SKIP() << "nothing was let go: try another";
  }
  EXPECT_EQ(diagnosis.before.chi2_reduced, diagnosis.after.chi2_reduced);
}

// The quiet before a pulse knows a hum's slope better than the rest of the record, in which a free
// source takes up what all gauges have alike, and a drift beside the hum would mend what is left of
// it there.
TEST(MainsHum, LeavesNoDriftToTheQuietBeforeIt) {
  for (std::uint64_t seed = 721; seed < 729; ++seed) {
    testing::CampaignWishes wishes{.seed = seed,
                                   .shots = 5,
                                   .gauges = 3,
                                   .noise_strain = 3.5e-6,
                                   .samples = 1800,
                                   .rate_Hz = 1e6};
    testing::Campaign campaign = testing::draw_campaign(wishes);
    testing::hide(campaign, testing::parse_effect("mains-hum=8.5e-5"));
    const Diagnosis diagnosis = diagnosed(testing::shots_of(campaign));
    EXPECT_EQ(diagnosis.effects, std::vector<std::string>{"mains-hum"}) << seed;
  }
}

/// A hum fitted at every gauge and shot.
Studied with_hum(Study& study) {
  Model model = paper_model(BenchKind::bar, true);
  EffectUse hum = null_use(*find_effect("mains-hum"), "");
  hum.per_shot = true;
  for (const std::size_t part : {0U, 1U}) {
    hum.values[part].free = true;
    hum.values[part].prior_sd = 1e-4;
  }
  hum.values[2].value = 50.0;
  hum.values[2].free = false;
  model.effects.push_back(hum);
  return study.fit(model, LearnNoise::no);
}

// A drift of each shot's own has to show before the pulses: in what they slope beside the hum that
// the model has, too.
TEST(OwnStrengths, OfADriftAreConfirmedBesideAHum) {
  testing::Campaign truth = elastic_bar(713, 6, 4, 3e-6);
  testing::hide(truth, testing::parse_effect("mains-hum=2e-4"));
  testing::CampaignForward forward;
  testing::Readings readings = forward.readings(truth);
  std::mt19937_64 random(713);
  std::normal_distribution<double> slope_per_s(0.0, 0.05);
  for (auto& shot : readings) {
    const double per_sample = slope_per_s(random) * 1e-6;
    for (std::size_t n = 0; n < shot[1].size(); ++n) {
      shot[1][n] += per_sample * static_cast<double>(n);
    }
  }
  const Campaign campaign = read_campaign(testing::shots_of(truth, readings));
  Study study(campaign, 0.0, Workers{});
  Model model = with_hum(study).model;
  EffectUse drift = null_use(*find_effect("baseline-drift"), "g2");
  drift.per_shot = true;
  drift.values[0].free = true;
  model.effects.push_back(drift);
  model.find("mains-hum")->alike = true;
  const Studied studied = study.fit(model, LearnNoise::no);
  EXPECT_TRUE(own_strengths_confirmed(studied, "baseline-drift:g2", campaign, Claim::fresh));
}

// In a metal bar the source takes up what all gauges have alike. A hum whose shares cancel, found
// with such a part, leaves gauges that slope together before the pulses, as they did not with it,
// and was taken for wander.
TEST(MainsHum, IsNoWanderForAPartThatTheSourceTakesUp) {
  constexpr double kAmplitude = 4e-5;
  testing::Campaign truth = elastic_bar(712, 4, 5, 4.7e-6);
  testing::hide(truth, testing::parse_effect("mains-hum=4e-5"));
  truth.world.hum.share = {0.8, -0.5, -0.5, 0.3, -0.1};
  const Campaign campaign = read_campaign(testing::shots_of(truth));
  Study study(campaign, 0.0, Workers{});
  Studied studied = with_hum(study);
  const auto confirmed = [&] {
    return own_strengths_confirmed(studied, "mains-hum", campaign, Claim::fresh);
  };
  EXPECT_TRUE(confirmed());
  for (std::size_t i = 0; i < studied.fit.theta.size(); ++i) {
    const FreeNumber& number = studied.composition.numbers()[i];
    if (number.shot >= 0) {
      const double phase = truth.world.shots[static_cast<std::size_t>(number.shot)].hum_phase;
      const double part = number.parameter == 0 ? std::cos(phase) : -std::sin(phase);
      studied.fit.theta[i] += kAmplitude * part / number.scale;
    }
  }
  EXPECT_TRUE(confirmed());
}

/// Gauges that pick up a hum the one way and the other by turns, at one phase in every shot.
testing::Campaign one_phase(std::uint64_t seed, testing::NoiseColour colour) {
  testing::Campaign campaign =
      testing::draw_campaign({.seed = seed, .shots = 6, .gauges = 4, .colour = colour});
  testing::hide(campaign, testing::parse_effect("mains-hum=8e-6,phase=1.3,others=-0.8"));
  return campaign;
}

// A source that is free takes up what gauges have alike of it, so that one gauge or two of four may
// be left to slope: as drifts of these it was named, and as nothing else.
TEST(Drifts, OfOneHumAreTiedWithIt) {
  using enum testing::NoiseColour;
  int drifts = 0;
  for (const auto& [seed, colour] : {std::pair{12U, pink}, {13U, coloured}}) {
    const Diagnosis diagnosis = diagnosed(testing::shots_of(one_phase(seed, colour)));
    drifts += says_hum(diagnosis) && diagnosis.effects[0] != "mains-hum" ? 1 : 0;
    for (const std::string& id : diagnosis.effects) {
      EXPECT_TRUE(id == "mains-hum" ||
                  std::ranges::count(diagnosis.tied_with.at(id), "mains-hum") == 1)
          << seed << " " << id;
    }
  }
  EXPECT_GT(drifts, 0) << "nothing to try it on";
}

// Of two gauges only their difference shows: either may drift, and a hum be in both.
TEST(Drifts, OfAHumInTwoGaugesAreTiedWithIt) {
  int drifts = 0;
  for (const std::uint64_t seed : {31U, 32U, 33U}) {
    testing::Campaign campaign = testing::draw_campaign(
        {.seed = seed, .shots = 6, .gauges = 2, .colour = testing::NoiseColour::white});
    testing::hide(campaign, testing::parse_effect("mains-hum=8e-6,phase=4,others=-0.8"));
    const Diagnosis diagnosis = diagnosed(testing::shots_of(campaign));
    for (const std::string& id : diagnosis.effects) {
      drifts += id != "mains-hum" ? 1 : 0;
      EXPECT_TRUE(id == "mains-hum" ||
                  std::ranges::count(diagnosis.tied_with.at(id), "mains-hum") == 1)
          << seed << " " << id;
    }
  }
  EXPECT_GT(drifts, 0) << "nothing to try it on";
}

// But a drift of one gauge stays one.
TEST(Drifts, OfOneGaugeAreNoHum) {
  int named = 0;
  for (const std::uint64_t seed : {2U, 3U, 4U}) {
    testing::Campaign campaign = testing::draw_campaign({.seed = seed, .shots = 6});
    testing::hide(campaign, testing::parse_effect("baseline-drift:g2=0.008"));
    const Diagnosis diagnosis = diagnosed(testing::shots_of(campaign));
    named += diagnosis.effects == std::vector<std::string>{"baseline-drift:g2"} &&
                     diagnosis.verdict == DiagnosisVerdict::named
                 ? 1
                 : 0;
  }
  EXPECT_EQ(named, 3);
}

// Slopes that every gauge has of its own in every shot are products by chance only.
TEST(Drifts, OfAllGaugesAreNoHum) {
  for (const std::uint64_t seed : {52U, 53U}) {
    const testing::Campaign campaign = elastic_bar(seed, 7, 3, 5e-6);
    const Diagnosis diagnosis =
        diagnosed_elastic(testing::shots_of(campaign, sloping(campaign, {0, 1, 2}, seed)));
    EXPECT_NE(diagnosis.effects, std::vector<std::string>{"mains-hum"}) << seed;
  }
}

}  // namespace
}  // namespace kolsky
