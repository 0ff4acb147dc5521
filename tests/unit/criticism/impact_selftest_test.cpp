#include <gtest/gtest.h>

#include <cmath>

#include "processing/base/error.hpp"
#include "processing/criticism/selftest/ball_planting.hpp"
#include "processing/criticism/selftest/selftest.hpp"
#include "processing/reduction/ball/ball_flight.hpp"
#include "tests/unit/criticism/thrown_balls.hpp"

namespace kolsky {
namespace {

testing::ImpactWishes wishes(std::uint64_t seed, std::vector<double> speeds_m_per_s) {
  testing::ImpactWishes own;
  own.seed = seed;
  own.speeds_m_per_s = std::move(speeds_m_per_s);
  own.shots = 1;
  return own;
}

/// What is planted, and the shots that it is planted into.
struct Planted {
  explicit Planted(std::vector<Shot> measured)
      : shots(std::move(measured)),
        campaign(read_campaign(shots)),
        study(campaign, JudgedStretch::to_reflection, 0.0, Workers{}, testing::light_meshes()),
        studied(study.fit(paper_model(BenchKind::impact, true))),
        planter(shots, study, studied) {}

  [[nodiscard]] std::vector<Shot> with(const char* id, double value) const {
    EffectUse use = use_named(id);
    use.values[0].value = value;
    return planter.planted(use, 0);
  }

  std::vector<Shot> shots;
  Campaign campaign;
  ImpactStudy study;
  Studied studied;
  BallPlanter planter;
};

/// Strain of the one gauge of the first shot.
std::vector<double> strain_of(const std::vector<Shot>& shots) {
  return read_campaign(shots).shots.front().strain.front();
}

double rebound_of(const Shot& shot) {
  return std::stod(shot.meta.at("rebound_speed_m_per_s"));
}

TEST(BallPlanter, PlantsWhatAnotherCodeOfTheBallSaysOfAStiffeningCore) {
  testing::ImpactWishes own = wishes(61, {51.0});
  const std::vector<Shot> linear = testing::impact_shots(own);
  own.core_b = 0.6;
  // The same noise and speed: what differs is the core's alone.
  const std::vector<Shot> stiff = testing::impact_shots(own);
  const Planted ground(linear);
  const std::vector<Shot> after = ground.with("core-nonlinearity", 0.6);
  const std::vector<double> before = strain_of(linear);
  const std::vector<double> wanted = strain_of(stiff);
  const std::vector<double> made = strain_of(after);
  double difference = 0.0;
  double size = 0.0;
  double peak = 0.0;
  for (std::size_t i = 0; i < 900; ++i) {  // until the far end's reflection is back
    difference += std::pow(made[i] - wanted[i], 2);
    size += std::pow(wanted[i] - before[i], 2);
    peak = std::max(peak, wanted[i]);
  }
  EXPECT_GT(std::sqrt(size / 900.0), 0.01 * peak);
  EXPECT_LT(std::sqrt(difference), 0.25 * std::sqrt(size));
  const double change = rebound_of(stiff[0]) - rebound_of(linear[0]);
  EXPECT_NEAR(rebound_of(after[0]) - rebound_of(linear[0]), change,
              0.3 * std::abs(change) + 1e-3 * rebound_of(linear[0]));
  // What the gauge's factor alone does leaves the ball's speed.
  const std::vector<Shot> larger = ground.with("gauge-factor:g1", 0.03);
  const std::vector<double> more = strain_of(larger);
  double most = 0.0;
  for (std::size_t i = 0; i < 900; ++i) {
    most = std::max(most, std::abs(more[i] - 1.03 * before[i]));
  }
  EXPECT_LT(most, 2e-3 * peak);
  EXPECT_EQ(rebound_of(larger[0]), rebound_of(linear[0]));
}

/// 1 where a ball is in a beam at `distance_m`, by how far its front is from the bar.
bool in_beam(double front_m, double distance_m) {
  return front_m < distance_m && distance_m < front_m + 0.0427;
}

/// The shot with quiet before and after it, and two beams instead of filed speeds.
Shot with_beams(const Shot& shot) {
  constexpr std::size_t kMore = 5000;
  Shot out = shot;
  const double in = std::stod(shot.meta.at("incident_speed_m_per_s"));
  const double away = rebound_of(shot);
  out.meta.clear();
  auto& codes = out.channels[0].codes;
  std::vector<std::int32_t> quiet;
  for (std::size_t i = 0; i < kMore; ++i) {
    quiet.push_back(codes[i % 350]);
  }
  codes.insert(codes.begin(), quiet.begin(), quiet.end());
  codes.insert(codes.end(), quiet.begin(), quiet.end());
  out.bench.photo_sensors = {{"p1", {0.06, 0.0}}, {"p2", {0.09, 0.0}}};
  const std::size_t samples = codes.size();
  const double touch_s = 400e-6 + kMore * 1e-6;
  for (const double distance_m : {0.06, 0.09}) {
    ChannelRecord beam = shot.channels[0];
    beam.codes.clear();
    for (std::size_t i = 0; i < samples; ++i) {
      const double t = static_cast<double>(i) * 1e-6 - touch_s;
      const double front_m = t < 0.0 ? -in * t : away * (t - 450e-6);
      beam.codes.push_back(in_beam(front_m, distance_m) ? 100 : 30000);
    }
    out.channels.push_back(std::move(beam));
  }
  return out;
}

TEST(BallPlanter, AnotherReboundPassesTheBeamsAtAnotherTime) {
  const std::vector<Shot> filed = testing::impact_shots(wishes(62, {40.3}));
  const std::vector<Shot> timed{with_beams(filed[0])};
  const auto seen = [](const Shot& shot) {
    return ball_flight(shot, 5400e-6).rebound_m_per_s.value().value;
  };
  ASSERT_NEAR(seen(timed[0]), rebound_of(filed[0]), 0.01);
  const double ratio =
      rebound_of(Planted(filed).with("core-nonlinearity", -0.6)[0]) / rebound_of(filed[0]);
  ASSERT_GT(std::abs(ratio - 1.0), 2e-3);
  const std::vector<Shot> after = Planted(timed).with("core-nonlinearity", -0.6);
  EXPECT_NEAR(seen(after[0]) / seen(timed[0]), ratio, 5e-4);
  EXPECT_NEAR(ball_flight(after[0], 5400e-6).incident_m_per_s.value().value,
              ball_flight(timed[0], 5400e-6).incident_m_per_s.value().value, 1e-9);
}

TEST(ImpactSelftest, FindsWhatWasPlantedLarge) {
  testing::ImpactWishes own = wishes(63, {51.0});
  SelftestOptions options;
  options.effects = {"core-nonlinearity"};
  options.sizes = {2.0};
  options.nulls = 0;
  options.meshes = testing::light_meshes();
  const Selftest result = selftest(testing::impact_shots(own), paper_model(BenchKind::impact, true),
                                   options, Workers{});
  EXPECT_EQ(result.untouched, DiagnosisVerdict::adequate);
  ASSERT_EQ(result.effects.size(), 1U);
  const PlantedEffect& effect = result.effects.front();
  ASSERT_EQ(effect.sizes.size(), 1U);
  EXPECT_TRUE(effect.sizes[0].found())
      << name_of(effect.sizes[0].outcome) << " " << ::testing::PrintToString(effect.sizes[0].said);
  EXPECT_LT(std::abs(effect.sizes[0].strength - 2.0), 4.0 * effect.sizes[0].sd);
}

TEST(ImpactSelftest, RefusesAModelOfAnotherBench) {
  testing::ImpactWishes own = wishes(64, {31.1});
  own.across = 4;
  EXPECT_THROW(
      (void)selftest(testing::impact_shots(own), paper_model(BenchKind::bar, false), {}, Workers{}),
      InputError);
}

}  // namespace
}  // namespace kolsky
