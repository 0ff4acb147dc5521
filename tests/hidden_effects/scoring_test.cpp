#include <gtest/gtest.h>

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <random>

#include "drivers/files/captures/capture.hpp"
#include "drivers/files/tables/table_import.hpp"
#include "tests/generators/campaign_files.hpp"
#include "tests/generators/noise.hpp"
#include "tests/hidden_effects/case_draw.hpp"
#include "tests/hidden_effects/failing_places.hpp"
#include "tests/hidden_effects/further_experiment.hpp"
#include "tests/hidden_effects/identifiability.hpp"
#include "tests/hidden_effects/plain_faults.hpp"
#include "tests/hidden_effects/score_table.hpp"
#include "tests/hidden_effects/source_freedom.hpp"
#include "tests/hidden_effects/stress_curve.hpp"
#include "tests/hidden_effects/whitening.hpp"
#include "tests/scratch_folder.hpp"

namespace kolsky::scoring {
namespace {

namespace fs = std::filesystem;

using Records = std::vector<std::vector<double>>;

Records random_records(std::size_t gauges, std::size_t samples, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  Records records(gauges, std::vector<double>(samples));
  for (auto& record : records) {
    for (double& value : record) {
      value = normal(random);
    }
  }
  return records;
}

// Against a plain least-squares fit of the same columns.
TEST(SourceFreedom, LeavesWhatADenseFitLeaves) {
  constexpr std::size_t kSamples = 60;
  constexpr std::ptrdiff_t kFirst = -9;
  constexpr std::size_t kStride = 4;
  const Records responses = random_records(2, kSamples + 9, 1);
  const std::vector<double> ones(kSamples, 1.0);
  const SourceFreedom freedom(responses, ones, kSamples, kFirst, kStride, 1e4);
  const Records a = random_records(2, kSamples, 2);
  const Records b = random_records(2, kSamples, 3);
  const Eigen::MatrixXd left = freedom.remaining_products({&a, &b});

  std::vector<Eigen::VectorXd> columns;
  for (std::ptrdiff_t start = kFirst; start < static_cast<std::ptrdiff_t>(kSamples);
       start += kStride) {
    Eigen::VectorXd column = Eigen::VectorXd::Zero(2 * kSamples);
    for (std::size_t g = 0; g < 2; ++g) {
      for (std::ptrdiff_t n = std::max<std::ptrdiff_t>(0, start);
           n < static_cast<std::ptrdiff_t>(kSamples); ++n) {
        column[static_cast<Eigen::Index>(g * kSamples) + n] =
            responses[g][static_cast<std::size_t>(n - start)];
      }
    }
    columns.push_back(column);
  }
  for (std::size_t g = 0; g < 2; ++g) {
    Eigen::VectorXd column = Eigen::VectorXd::Zero(2 * kSamples);
    column.segment(static_cast<Eigen::Index>(g * kSamples), kSamples).setOnes();
    columns.push_back(column);
  }
  Eigen::MatrixXd design(2 * kSamples, static_cast<Eigen::Index>(columns.size()));
  for (std::size_t i = 0; i < columns.size(); ++i) {
    design.col(static_cast<Eigen::Index>(i)) = columns[i];
  }
  Eigen::MatrixXd seen(2 * kSamples, 2);
  for (std::size_t g = 0; g < 2; ++g) {
    for (std::size_t n = 0; n < kSamples; ++n) {
      seen(static_cast<Eigen::Index>(g * kSamples + n), 0) = a[g][n];
      seen(static_cast<Eigen::Index>(g * kSamples + n), 1) = b[g][n];
    }
  }
  const Eigen::MatrixXd rest = seen - design * design.colPivHouseholderQr().solve(seen);
  const Eigen::MatrixXd want = rest.transpose() * rest;
  EXPECT_LT((left - want).norm(), 1e-4 * want.norm());
  EXPECT_LT(want.norm(), 0.9 * (seen.transpose() * seen).norm());

  const Records remainder = freedom.remainder(a);
  for (std::size_t g = 0; g < 2; ++g) {
    for (std::size_t n = 0; n < kSamples; ++n) {
      EXPECT_NEAR(remainder[g][n], rest(static_cast<Eigen::Index>(g * kSamples + n), 0), 1e-3);
    }
  }
}

TEST(Whitening, MakesColouredNoiseWhite) {
  std::mt19937_64 random(5);
  Records samples;
  for (int i = 0; i < 40; ++i) {
    samples.push_back(testing::noise(testing::NoiseColour::pink, 4e-6, 1e-6, 4096, random));
  }
  const Whitening whiten(samples, 40);
  const std::vector<double> white =
      whiten(testing::noise(testing::NoiseColour::pink, 4e-6, 1e-6, 200000, random));
  double power = 0.0;
  double neighbour = 0.0;
  double far = 0.0;
  for (std::size_t n = 100; n < white.size(); ++n) {
    power += white[n] * white[n];
    neighbour += white[n] * white[n - 1];
    far += white[n] * white[n - 30];
  }
  const double count = static_cast<double>(white.size()) - 100.0;
  EXPECT_NEAR(power / count, 1.0, 0.05);
  EXPECT_NEAR(neighbour / power, 0.0, 0.02);
  EXPECT_NEAR(far / power, 0.0, 0.02);
}

testing::Campaign small_bench() {
  testing::CampaignWishes wishes;
  wishes.seed = 11;
  wishes.shots = 3;
  wishes.gauges = 3;
  wishes.rate_Hz = 1e6;
  wishes.samples = 1000;
  wishes.bits = 16;
  return testing::draw_campaign(wishes);
}

TEST(Identifiability, TwiceTheNoiseNeedsTwiceTheSize) {
  testing::Campaign campaign = small_bench();
  campaign.bits = 0;
  const Identifiability quiet(campaign);
  campaign.wishes.noise_strain *= 2.0;
  const Identifiability loud(campaign);
  for (std::size_t i = 0; i < quiet.effects().size(); ++i) {
    const Identifiable& a = quiet.effects()[i];
    if (!a.possible()) {
      continue;
    }
    // A little less than twice: the sources' weak prior does not grow with the noise.
    double ratio = loud.effects()[i].smallest / a.smallest;
    if (a.candidate.effect.id == "gauge-length") {
      ratio *= ratio;  // grows with the square of the length
    }
    EXPECT_LT(ratio, 2.01) << a.candidate.effect.name();
    EXPECT_GT(ratio, 1.75) << a.candidate.effect.name();
    EXPECT_GE(a.smallest, a.detect);
  }
  // First in the known ties.
  const auto delay = std::ranges::find_if(quiet.effects(), [](const Identifiable& effect) {
    return effect.candidate.effect.name() == "channel-delay:g2";
  });
  ASSERT_NE(delay, quiet.effects().end());
  EXPECT_EQ(delay->closest, "amplifier-bandwidth:g2");
  EXPECT_LT(delay->rival_share, 5e-3);
  EXPECT_TRUE(delay->seen_but_tied());
}

// Of three gauges on a bar whose moduli are free one ratio of distances is known, and which of the
// three is off it does not tell.
TEST(Identifiability, PlacesOfThreeGaugesAreTied) {
  testing::Campaign campaign = small_bench();
  campaign.wishes.noise_strain = 1e-6;
  const Identifiability quiet(campaign);
  for (const Identifiable& effect : quiet.effects()) {
    if (effect.candidate.effect.id == "gauge-position") {
      EXPECT_LT(effect.rival_share, 0.05) << effect.candidate.effect.name();
      EXPECT_TRUE(effect.seen_but_tied()) << effect.candidate.effect.name();
    }
    // A length is told from all else, and a drift.
    if (effect.candidate.effect.id == "gauge-length" ||
        effect.candidate.effect.id == "baseline-drift") {
      EXPECT_TRUE(effect.possible()) << effect.candidate.effect.name();
    }
  }
}

TEST(Campaign, TablesAndCapturesHoldTheSame) {
  testing::Campaign campaign = small_bench();
  testing::hide(campaign, testing::parse_effect("gauge-factor:g2=0.02"));
  const testing::ScratchFolder scratch;
  const fs::path folder = scratch / "campaign";
  const auto captures = testing::write_campaign({.folder = folder}, testing::shots_of(campaign));
  const Shot stored = read_capture(captures[1]);
  TableImport request;
  request.tables = {folder / "shot02.csv"};
  request.bench = folder / "bench.toml";
  const Shot imported = import_tables(request);
  ASSERT_EQ(imported.samples(), 1000u);
  for (std::size_t g = 0; g < 3; ++g) {
    const ChannelRecord& a = stored.channels[g];
    const ChannelRecord& b = imported.channels[g];
    for (std::size_t n = 0; n < 1000; ++n) {
      ASSERT_NEAR(a.value(a.codes[n]), b.value(b.codes[n]), 1e-11);
    }
  }
  for (const auto& entry : fs::directory_iterator(folder)) {
    EXPECT_EQ(entry.path().string().find("truth"), std::string::npos);
  }
}

// Tables of the noncentral chi-square distribution, 5 % and 80 %.
// One draw of what is filed would be in all cases of a bench, and its moduli's errors with it.
TEST(Campaign, TruthIsDrawnAnewWithinWhatIsFiled) {
  testing::Campaign campaign =
      testing::draw_campaign({.seed = 4, .tolerances = testing::Tolerances::filed});
  std::mt19937_64 random(8);
  constexpr int kDraws = 400;
  double positions = 0.0;
  double densities = 0.0;
  double gains = 0.0;
  for (int n = 0; n < kDraws; ++n) {
    testing::draw_truth_anew(random, campaign);
    const Gauge& gauge = campaign.bench.gauges[1];
    const auto square = [](double truth, const Measured& filed) {
      return std::pow((truth - filed.value) / filed.sd, 2) / kDraws;
    };
    positions += square(campaign.world.gauges[1].position_m, gauge.position_m);
    densities += square(campaign.world.material.density_kg_m3, campaign.bench.input.density_kg_m3);
    gains += square(gauge.strain_per_V->value / campaign.world.gauges[1].gain, *gauge.strain_per_V);
  }
  for (const double mean_square : {positions, densities, gains}) {
    EXPECT_NEAR(mean_square, 1.0, 0.3);
  }
}

TEST(FailingPlaces, CountFromWhereATestFindsThem) {
  EXPECT_NEAR(findable_excess(1.0), 7.849, 2e-3);
  EXPECT_NEAR(findable_excess(2.0), 9.635, 2e-3);
  EXPECT_NEAR(findable_excess(10.0), 16.24, 1e-2);
}

// On a bar without losses all gauges see one wave. A gain that is off at one of three leaves two
// thirds of itself there, in noise of two thirds of its power, and a third of itself elsewhere.
TEST(FailingPlaces, HaveTheEnergyThatAFreeSourceLeaves) {
  testing::CampaignWishes wishes;
  wishes.seed = 11;
  wishes.shots = 2;
  wishes.gauges = 3;
  wishes.rate_Hz = 1e6;
  wishes.samples = 1000;
  wishes.bits = 0;
  wishes.elastic = true;
  const testing::Campaign bare = testing::draw_campaign(wishes);
  constexpr double kGain = 0.02;
  testing::Campaign hidden = bare;
  testing::hide(hidden, testing::parse_effect("gauge-factor:g2=0.02"));
  Places places{{{1e3, 10e3}, {10e3, 30e3}}, {}};
  for (const char* gauge : {"g1", "g2", "g3"}) {
    places.stretches.push_back({gauge, "all", 0, 0.0, 1e-3, 0.0, 0.0, false});
  }
  FailingPlaces failing(bare);
  std::vector<PlaceTruth> found = failing.of(hidden, places);
  std::erase_if(found, [](const PlaceTruth& place) { return std::get<3>(place.place) == 0; });
  ASSERT_EQ(found.size(), 3U);
  EXPECT_TRUE(found[1].touched);
  EXPECT_FALSE(found[0].touched);

  const std::vector<double> reading = testing::CampaignForward().readings(bare)[0][1];
  double energy = 0.0;
  for (int f = 10; f < 30; ++f) {
    std::complex<double> line = 0.0;
    for (std::size_t n = 0; n < reading.size(); ++n) {
      line += reading[n] * std::polar(1.0, -2e-3 * std::numbers::pi * f * static_cast<double>(n));
    }
    energy += 2.0 / 1000.0 * std::norm(line * kGain / wishes.noise_strain);
  }
  EXPECT_NEAR(found[1].freedom, 40.0, 10.0);  // twice as many as lines
  EXPECT_NEAR(found[1].excess / energy, 2.0 / 3.0, 0.2);
  EXPECT_NEAR(found[0].excess / energy, 1.0 / 6.0, 0.05);
  EXPECT_TRUE(found[1].fails());
}

TEST(FailingPlaces, AreNoneWhereNothingIsHiddenOrNothingArrivesYet) {
  const testing::Campaign bare = small_bench();
  testing::Campaign hidden = bare;
  testing::hide(hidden, testing::parse_effect("gauge-factor:g2=0.01"));
  const testing::Timing& timing = bare.world.timing;
  const double pulse_s = static_cast<double>(timing.pretrigger) * timing.period_s() - 40e-6;
  Places places{{{5e3, 10e3}, {10e3, 20e3}}, {}};
  places.stretches = {{"g2", "before the pulse", 0, 0.0, pulse_s, 0.0, 20e-6, true},
                      {"g2", "incident pulse", 0, pulse_s, 8e-4, 20e-6, 20e-6, false}};
  FailingPlaces failing(bare);
  for (const PlaceTruth& place : failing.of(bare, places)) {
    EXPECT_LT(place.excess, 1e-12);
  }
  for (const PlaceTruth& place : failing.of(hidden, places)) {
    EXPECT_EQ(place.fails(), std::get<1>(place.place) == "incident pulse");
  }
}

TEST(Localisation, CountsWhatIsMarkedOfWhatFails) {
  const auto compared = nlohmann::json::parse(R"({
    "places": {"shots": ["a", "b"], "bands_Hz": [[1e3, 2e3], [2e3, 4e3]],
      "windows": [{"shot": "b", "gauge": "g1", "window": "before the pulse", "start_s": 0.0,
                   "end_s": 1e-4, "fade_in_s": 0.0, "fade_out_s": 2e-5}]},
    "where": [{"gauge": "g1", "window": "later", "shot": "b", "band_Hz": [2e3, 4e3],
               "significant": true},
              {"gauge": "g2", "window": "later", "shot": "a", "band_Hz": [1e3, 2e3],
               "significant": true}]})");
  const Places places = places_of(compared);
  ASSERT_EQ(places.stretches.size(), 1U);
  EXPECT_EQ(places.stretches[0].shot, 1U);
  EXPECT_TRUE(places.stretches[0].quiet);
  EXPECT_EQ(places.bands_Hz[1], (std::pair{2e3, 4e3}));

  const std::vector<PlaceTruth> truth{{{"g1", "later", 1, 1}, 100.0, 4.0, true, false},
                                      {{"g1", "later", 0, 1}, 100.0, 4.0, true, false},
                                      {{"g1", "later", 1, 0}, 1.0, 4.0, true, false},
                                      {{"g1", "later", 0, 0}, 100.0, 4.0, true, true},
                                      {{"g2", "later", 0, 0}, 0.0, 4.0, false, false}};
  const Localisation found = localisation(truth, marked_by(compared));
  EXPECT_EQ(found.all.failing, 2U);
  EXPECT_EQ(found.all.marked, 2U);
  EXPECT_EQ(found.all.both, 1U);
  EXPECT_DOUBLE_EQ(found.all.f1(), 0.5);
  EXPECT_DOUBLE_EQ(found.touched.precision(), 1.0);
  EXPECT_DOUBLE_EQ(found.touched.recall(), 0.5);
  EXPECT_NEAR(found.ideal_both, 2.0, 1e-3);

  std::vector<Verdict> verdicts(1);
  verdicts[0].places = found;
  const std::string table = table_text(measures(verdicts));
  const std::size_t line = table.find("localisation of the failure");
  EXPECT_NE(table.find("0.500       1  SHORT", line), std::string::npos);
}

Case single(const std::string& effect) {
  Case made{"b0", CaseKind::single, {}, {}, {2.0}};
  made.campaign.effects = {testing::parse_effect(effect)};
  return made;
}

TEST(Verdict, CountsSetsExactNamesAndStrengths) {
  Answer answer;
  answer.json = nlohmann::json::parse(R"({"verdict": "tied", "effects": ["channel-delay:g2"],
    "tied_with": {"channel-delay:g2": ["amplifier-bandwidth:g2"]},
    "misfit": {"held_out": {"before": 3.0, "after": 1.2, "floor": 1.0}},
    "candidates": [{"effect": "amplifier-bandwidth:g2", "strength": 2.2e-6, "sd": 1e-7}]})");
  const Verdict tied = judge(single("amplifier-bandwidth:g2=2e-6"), answer);
  EXPECT_EQ(tied.found, 1);
  EXPECT_FALSE(tied.exact);
  EXPECT_EQ(tied.set_size, 2.0);
  EXPECT_NEAR(*tied.closure, 0.9, 1e-12);
  EXPECT_NEAR(*tied.strength_in_sd, 2.0, 1e-9);
  EXPECT_EQ(judge(single("gauge-position:g2=1e-3"), answer).found, 0);

  answer.json["tied_with"] = {{"channel-delay:g2", nlohmann::json::array()}};
  EXPECT_TRUE(judge(single("channel-delay:g2=2e-6"), answer).exact);
  EXPECT_FALSE(judge(single("channel-delay:g1=2e-6"), answer).exact);

  answer.code = 124;
  EXPECT_EQ(judge(single("channel-delay:g2=2e-6"), answer).answered, "timeout");
}

// What was drawn within a filed deviation is part of what an analyser finds.
TEST(Verdict, CountsAFiledNumbersWholeError) {
  testing::CampaignWishes wishes;
  wishes.tolerances = testing::Tolerances::filed;
  Case made{"b0", CaseKind::single, testing::draw_campaign(wishes), {}, {2.0}};
  const double drawn = made.campaign.world.gauges[1].position_m;
  testing::hide(made.campaign, testing::parse_effect("gauge-position:g2=0.004"));
  const double found = drawn + 0.004 - made.campaign.bench.gauges[1].position_m;
  Answer answer;
  answer.json = {{"verdict", "named"},
                 {"effects", {"gauge-position:g2"}},
                 {"candidates",
                  {{{"effect", "gauge-position:g2"}, {"strength", found + 1e-4}, {"sd", 5e-5}}}}};
  EXPECT_NEAR(*judge(made, answer).strength_in_sd, 2.0, 1e-6);
  EXPECT_GT(std::abs(found - 0.004), 1e-6);
}

TEST(FurtherExperiment, ChangesWhatIsProposedAndNothingElse) {
  const testing::Campaign campaign = testing::draw_campaign({});
  EXPECT_FALSE(changed_as_proposed(campaign, "the channels swapped").has_value());
  const auto gauge = changed_as_proposed(campaign, "a further gauge between those there are");
  ASSERT_TRUE(gauge.has_value());
  EXPECT_EQ(gauge->world.gauges.size(), campaign.world.gauges.size() + 1);
  EXPECT_EQ(gauge->bench.gauges.size(), campaign.bench.gauges.size() + 1);
  EXPECT_EQ(gauge->world.shots[0].source, campaign.world.shots[0].source);
  const auto shorter = changed_as_proposed(campaign, "a shorter striker");
  ASSERT_TRUE(shorter.has_value());
  const auto lasting = [](const std::vector<double>& bells) {
    const double top = *std::ranges::max_element(bells);
    return std::ranges::count_if(bells, [&](double bell) { return bell > 0.5 * top; });
  };
  const auto before = static_cast<double>(lasting(campaign.world.shots[0].source));
  EXPECT_NEAR(static_cast<double>(lasting(shorter->world.shots[0].source)), 0.5 * before, 2.0);
}

TEST(Verdict, TwoEffectsNeedASetEach) {
  Case two = single("gauge-factor:g1=0.01");
  two.kind = CaseKind::two;
  two.campaign.effects.push_back(testing::parse_effect("temperature=0.003"));
  Answer answer;
  answer.json = nlohmann::json::parse(
      R"({"verdict": "named", "effects": ["x"], "tied_with": {"x": ["gauge-factor:g1", "temperature"]}})");
  EXPECT_EQ(judge(two, answer).found, 1);
  answer.json = nlohmann::json::parse(
      R"({"verdict": "named", "effects": ["temperature", "gauge-factor:g1"], "tied_with": {}})");
  EXPECT_EQ(judge(two, answer).found, 2);
  EXPECT_TRUE(judge(two, answer).exact);
}

Verdict verdict_on(CaseKind kind, double multiple, std::vector<std::string> named, int found) {
  Verdict made;
  made.id = "b0";
  made.kind = kind;
  made.answered = named.empty() ? "unknown" : "named";
  made.multiples = {multiple};
  made.named = std::move(named);
  made.found = found;
  return made;
}

TEST(PlainFaults, AreFalseClaimsAndClearEffectsMissed) {
  const auto faults = [](const Verdict& verdict) { return plain_faults({verdict}).size(); };
  EXPECT_EQ(faults(verdict_on(CaseKind::null, 0.0, {}, 0)), 0U);
  EXPECT_EQ(faults(verdict_on(CaseKind::null, 0.0, {"bending"}, 0)), 1U);
  EXPECT_EQ(faults(verdict_on(CaseKind::withheld, 2.0, {}, 0)), 0U);
  EXPECT_EQ(faults(verdict_on(CaseKind::withheld, 2.0, {"bending"}, 0)), 1U);
  EXPECT_EQ(faults(verdict_on(CaseKind::absorbed, 0.1, {"bending"}, 0)), 1U);
  EXPECT_EQ(faults(verdict_on(CaseKind::single, 4.0, {"bending"}, 1)), 0U);
  EXPECT_EQ(faults(verdict_on(CaseKind::single, 4.0, {}, 0)), 1U);
  // At its smallest identifiable size chance may hide it, but not name another.
  EXPECT_EQ(faults(verdict_on(CaseKind::single, 1.0, {}, 0)), 0U);
  EXPECT_EQ(faults(verdict_on(CaseKind::single, 1.0, {"crosstalk:g2"}, 0)), 1U);
  Verdict late = verdict_on(CaseKind::null, 0.0, {}, 0);
  late.answered = "timeout";
  EXPECT_EQ(faults(late), 1U);
}

TEST(ScoreTable, MarksWhatFallsShort) {
  std::vector<Verdict> verdicts(100);
  for (Verdict& verdict : verdicts) {
    verdict.answered = "adequate";
  }
  verdicts[0].named = verdicts[1].named = {"bending"};
  std::vector<Measure> table = measures(verdicts);
  EXPECT_NEAR(*table[0].got, 0.02, 1e-12);
  EXPECT_FALSE(table[0].met);
  EXPECT_FALSE(table[1].got.has_value());
  verdicts[0].named.clear();
  EXPECT_TRUE(measures(verdicts)[0].met);
}

// At a constant rate r: dstress/dt + stress (E1 + E2)/eta = E1 (r + E2 r t/eta).
TEST(StressCurve, IsTheClosedFormOfALinearSolid) {
  const testing::TrueSpecimen specimen;
  constexpr double kLoading_s = 100e-6;
  constexpr double kRate = 800.0;
  std::vector<double> strain;
  for (int i = 0; i <= 50; ++i) {
    strain.push_back(kRate * kLoading_s * std::pow(i / 50.0, 1.2));
  }
  const std::vector<double> stress = true_stress_Pa(specimen, strain, kLoading_s);
  const double lambda = (specimen.E1_Pa + specimen.E2_Pa) / specimen.eta2_Pa_s;
  const double a = specimen.E1_Pa * kRate;
  const double b = a * specimen.E2_Pa / specimen.eta2_Pa_s;
  for (std::size_t i = 1; i < strain.size(); ++i) {
    const double t = strain[i] / kRate;
    const double exact =
        b / lambda * t + (a / lambda - b / (lambda * lambda)) * (1.0 - std::exp(-lambda * t));
    EXPECT_NEAR(stress[i], exact, 1e-6 * exact) << i;
  }
  testing::TrueSpecimen stiffer = specimen;
  stiffer.nonlinearity = 2.0;
  EXPECT_GT(true_stress_Pa(stiffer, strain, kLoading_s).back(), 1.03 * stress.back());
}

}  // namespace
}  // namespace kolsky::scoring
