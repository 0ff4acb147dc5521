// Records of bars are made in the time domain (tests/generators), with benches that are filed
// wrong.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include "processing/base/error.hpp"
#include "processing/calibration/calibration.hpp"
#include "tests/generators/campaign.hpp"

namespace kolsky {
namespace {

/// Enough samples for what comes back from the far end to be in the records.
constexpr int kLong = 1536;
/// Enough for the pulse's first passage at every gauge, and less of the price.
constexpr int kShort = 1024;

enum class FarEnd { free, silent };

testing::Campaign campaign(std::uint64_t seed, testing::Tolerances tolerances, int shots,
                           const std::vector<std::string>& effects = {}, int samples = kShort,
                           FarEnd far_end = FarEnd::free) {
  testing::CampaignWishes wishes{
      .seed = seed, .shots = shots, .tolerances = tolerances, .samples = samples, .rate_Hz = 5e5};
  testing::Campaign made = testing::draw_campaign(wishes);
  if (far_end == FarEnd::free) {
    testing::hide(made, testing::parse_effect("end-reflection=0"));
  }
  for (const std::string& effect : effects) {
    testing::hide(made, testing::parse_effect(effect));
  }
  return made;
}

const CalibratedNumber& number(const PartResult& part, const std::string& id) {
  const auto found = std::find_if(part.numbers.begin(), part.numbers.end(),
                                  [&](const auto& n) { return n.id == id; });
  EXPECT_NE(found, part.numbers.end()) << id;
  return *found;
}

std::vector<std::string> named(const Calibration& calibration) {
  std::vector<std::string> ids;
  for (const PartResult& part : calibration.parts) {
    for (const CalibratedNumber& n : part.numbers) {
      if (n.standing == Standing::differs || n.standing == Standing::tied) {
        ids.push_back(n.id);
      }
    }
  }
  return ids;
}

TEST(BarCalibration, BenchFiledWithinItsDeviationsPasses) {
  const testing::Campaign made = campaign(3, testing::Tolerances::filed, 3, {}, kLong);
  const Calibration calibration = calibrate(testing::shots_of(made), {});
  EXPECT_EQ(calibration.certificate, Certificate::pass);
  ASSERT_EQ(calibration.parts.size(), 1U);
  const PartResult& part = calibration.parts.front();
  EXPECT_TRUE(part.far_end_seen);
  EXPECT_FALSE(part.exact_waves);
  EXPECT_NEAR(part.chi2_reduced, 1.0, 0.1);
  EXPECT_TRUE(named(calibration).empty());
  EXPECT_TRUE(calibration.reasons.empty());
  // No shot tells a common gain: what enters the bar is free.
  EXPECT_EQ(part.cannot_tell.front(),
            "gauge-factor:g1, gauge-factor:g2, gauge-factor:g3, gauge-factor:g4");
}

/// Phase speed of elementary waves in a solid of three elements.
double speed_m_per_s(const testing::Campaign& made, double frequency_Hz) {
  const auto& solid = made.world.material;
  const std::complex<double> i_omega(0.0, 2.0 * std::numbers::pi * frequency_Hz);
  const std::complex<double> J =
      1.0 / solid.E1_Pa + 1.0 / (solid.E2_Pa + i_omega * solid.eta2_Pa_s);
  return 1.0 / std::sqrt(solid.density_kg_m3 * J).real();
}

// Judged with a return that is not there, exact waves look better than elementary ones.
TEST(BarCalibration, BenchWhoseFarEndReturnsNothingPasses) {
  for (const std::uint64_t seed : {102U, 303U}) {
    const testing::Campaign made =
        campaign(seed, testing::Tolerances::filed, 2, {}, kLong, FarEnd::silent);
    const Calibration calibration = calibrate(testing::shots_of(made), {});
    EXPECT_EQ(calibration.certificate, Certificate::pass) << seed;
    const PartResult& part = calibration.parts.front();
    EXPECT_FALSE(part.far_end_seen) << seed;
    EXPECT_FALSE(part.exact_waves) << seed;
    EXPECT_NEAR(part.chi2_reduced, 1.0, 0.1) << seed;
    EXPECT_NEAR(part.wave_speed_m_per_s.value, speed_m_per_s(made, part.wave_speed_at_Hz),
                4.0 * part.wave_speed_m_per_s.sd)
        << seed;
    EXPECT_LT(part.wave_speed_m_per_s.sd, 10.0) << seed;
  }
}

TEST(BarCalibration, TellsHowFarItIs) {
  const testing::Campaign made =
      campaign(3, testing::Tolerances::filed, 2, {"gauge-position:g3=0.005"});
  std::vector<std::string> steps;
  CalibrationOptions options;
  options.progress = [&steps](const std::string& step) { steps.push_back(step); };
  const Calibration calibration = calibrate(testing::shots_of(made), options);
  EXPECT_EQ(named(calibration), std::vector<std::string>{"gauge-position:g3"});
  const auto told = [&steps](const std::string& part) {
    return std::any_of(steps.begin(), steps.end(), [&](const std::string& step) {
      return step.find(part) != std::string::npos;
    });
  };
  EXPECT_TRUE(told("as filed"));
  EXPECT_TRUE(told("with gauge-position:g3 free"));
  EXPECT_TRUE(told("1 set free"));
}

TEST(BarCalibration, GaugeFiveMillimetresOffIsNamedWithItsPlace) {
  const testing::Campaign made =
      campaign(3, testing::Tolerances::filed, 3, {"gauge-position:g3=0.005"});
  const Calibration calibration = calibrate(testing::shots_of(made), {});
  EXPECT_EQ(calibration.certificate, Certificate::fail);
  EXPECT_EQ(named(calibration), std::vector<std::string>{"gauge-position:g3"});
  const CalibratedNumber& found = number(calibration.parts.front(), "gauge-position:g3");
  EXPECT_NEAR(found.measured.value, made.world.gauges[2].position_m, 3.0 * found.measured.sd);
  EXPECT_LT(found.measured.sd, 0.5e-3);
  EXPECT_GT(calibration.parts.front().chi2_reduced_as_filed,
            calibration.parts.front().chi2_reduced);
}

TEST(BarCalibration, GainThreePerCentOffIsNamedWithItsFactor) {
  const testing::Campaign made =
      campaign(5, testing::Tolerances::none, 3, {"gauge-factor:g2=0.03"});
  const Calibration calibration = calibrate(testing::shots_of(made), {});
  EXPECT_EQ(calibration.certificate, Certificate::fail);
  EXPECT_EQ(named(calibration), std::vector<std::string>{"gauge-factor:g2"});
  const PartResult& part = calibration.parts.front();
  const CalibratedNumber& found = number(part, "gauge-factor:g2");
  EXPECT_NEAR(found.measured.value, 1.03, 3.0 * found.measured.sd);
  EXPECT_LT(found.measured.sd, 1e-3);
  // The same without any model of the waves.
  ASSERT_EQ(part.areas.ratios.size(), 3U);
  EXPECT_NEAR(part.areas.ratios[0].ratio.value, 1.03, 4.0 * part.areas.ratios[0].ratio.sd);
  EXPECT_NEAR(part.areas.ratios[1].ratio.value, 1.0, 4.0 * part.areas.ratios[1].ratio.sd);
}

TEST(BarCalibration, SeveralFaultsAreNamedTogether) {
  const testing::Campaign made = campaign(5, testing::Tolerances::none, 3,
                                          {"gauge-factor:g2=0.03", "channel-delay:g4=2e-6"}, kLong);
  const Calibration calibration = calibrate(testing::shots_of(made), {});
  EXPECT_EQ(named(calibration), (std::vector<std::string>{"gauge-factor:g2", "channel-delay:g4"}));
  const CalibratedNumber& late = number(calibration.parts.front(), "channel-delay:g4");
  EXPECT_NEAR(late.measured.value, 2e-6, 3.0 * late.measured.sd);
}

TEST(BarCalibration, ExchangedGaugesAreSeen) {
  testing::Campaign made = campaign(5, testing::Tolerances::filed, 3);
  std::vector<Shot> shots = testing::shots_of(made);
  for (Shot& shot : shots) {
    std::swap(shot.channels[1].codes, shot.channels[2].codes);
  }
  const Calibration calibration = calibrate(shots, {});
  EXPECT_EQ(calibration.certificate, Certificate::fail);
  const PartResult& part = calibration.parts.front();
  ASSERT_EQ(part.swapped.size(), 1U);
  EXPECT_EQ(part.swapped.front(), (std::pair<std::string, std::string>{"g2", "g3"}));
  EXPECT_GT(part.chi2_reduced_as_filed, 20.0);
  EXPECT_EQ(named(calibration), std::vector<std::string>{});
}

TEST(BarCalibration, MaterialFiledOffIsNamed) {
  const testing::Campaign made = campaign(8, testing::Tolerances::none, 4);
  Material material;
  material.density_kg_m3 = {made.world.material.density_kg_m3};
  material.poisson_ratio = {made.world.material.poisson_ratio};
  material.E1_Pa() = {made.world.material.E1_Pa * 1.02, made.world.material.E1_Pa * 1e-3};
  material.E2_Pa() = {made.world.material.E2_Pa, made.world.material.E2_Pa * 1e-2};
  material.eta2_Pa_s() = {made.world.material.eta2_Pa_s, made.world.material.eta2_Pa_s * 1e-2};
  CalibrationOptions options;
  options.bars = BarPrior(material);
  const Calibration calibration = calibrate(testing::shots_of(made), options);
  EXPECT_EQ(named(calibration), std::vector<std::string>{"E1_Pa"});
  const CalibratedNumber& found = number(calibration.parts.front(), "E1_Pa");
  EXPECT_NEAR(found.measured.value, made.world.material.E1_Pa, 3.0 * found.measured.sd);
}

TEST(BarCalibration, JudgesNoFurtherThanItsBarsAreKnown) {
  constexpr double kKnown_Hz = 8e3;
  const testing::Campaign made = campaign(8, testing::Tolerances::filed, 2);
  const std::vector<Shot> shots = testing::shots_of(made);
  Material material = paper_pmma();
  material.density_kg_m3 = {made.world.material.density_kg_m3};
  material.E1_Pa() = {made.world.material.E1_Pa, made.world.material.E1_Pa * 1e-2};
  material.E2_Pa() = {made.world.material.E2_Pa, made.world.material.E2_Pa * 0.1};
  material.eta2_Pa_s() = {made.world.material.eta2_Pa_s, made.world.material.eta2_Pa_s * 0.1};
  material.identified = Material::Identified{kKnown_Hz, std::nullopt};
  CalibrationOptions known;
  known.bars = BarPrior(material);
  CalibrationOptions asked = known;
  asked.band_limit_Hz = kKnown_Hz;
  const CalibratedNumber by_bars = number(calibrate(shots, known).parts.front(), "E1_Pa");
  const CalibratedNumber by_hand = number(calibrate(shots, asked).parts.front(), "E1_Pa");
  EXPECT_EQ(by_bars.measured.value, by_hand.measured.value);
  EXPECT_EQ(by_bars.measured.sd, by_hand.measured.sd);
}

/// How often the truth lies within 1.96 stated deviations.
TEST(BarCalibration, StatedIntervalsHoldTheTruth) {
  constexpr int kRepeats = 3;
  int inside = 0;
  int all = 0;
  int passed = 0;
  double squares = 0.0;
  for (int repeat = 0; repeat < kRepeats; ++repeat) {
    const testing::Campaign made =
        campaign(100 + static_cast<std::uint64_t>(repeat), testing::Tolerances::filed, 3);
    const Calibration calibration = calibrate(testing::shots_of(made), {});
    passed += calibration.certificate == Certificate::pass ? 1 : 0;
    const PartResult& part = calibration.parts.front();
    for (const testing::TrueGauge& gauge : made.world.gauges) {
      const CalibratedNumber& gain = number(part, "gauge-factor:" + gauge.name);
      const CalibratedNumber& place = number(part, "gauge-position:" + gauge.name);
      for (const double z : {(gain.combined.value - gauge.gain) / gain.combined.sd,
                             (place.combined.value - gauge.position_m) / place.combined.sd}) {
        inside += std::abs(z) < 1.96 ? 1 : 0;
        squares += z * z;
        ++all;
      }
    }
  }
  std::printf("inside 95 %%: %d of %d, mean square %.3f, passed %d of %d\n", inside, all,
              squares / all, passed, kRepeats);
  EXPECT_GE(passed, kRepeats - 1);
  EXPECT_GE(inside, all - 5);
  EXPECT_GT(squares / all, 0.2);
}

TEST(BarCalibration, RefusesWhatCannotServe) {
  const testing::Campaign made = campaign(3, testing::Tolerances::filed, 2, {}, kLong);
  std::vector<Shot> shots = testing::shots_of(made);
  EXPECT_THROW((void)calibrate({}, {}), InputError);
  CalibrationOptions options;
  options.trusted = {"g9"};
  EXPECT_THROW((void)calibrate(shots, options), InputError);
  std::vector<Shot> silent = shots;
  for (ChannelRecord& channel : silent[1].channels) {
    std::fill(channel.codes.begin() + 200, channel.codes.end(), channel.codes[100]);
  }
  EXPECT_THROW((void)calibrate(silent, {}), InputError);
  std::vector<Shot> struck = shots;
  struck[0].meta["striker_speed_m_per_s"] = "12,5";
  for (Shot& shot : struck) {
    shot.bench.striker = Striker{Measured{0.2}, shot.bench.input.diameter_m,
                                 shot.bench.input.density_kg_m3, Measured{12.0, 0.1}};
  }
  try {
    (void)calibrate(struck, {});
    ADD_FAILURE() << "12,5 is no speed";
  } catch (const InputError& error) {
    EXPECT_NE(error.place().find("striker_speed_m_per_s"), std::string::npos) << error.what();
  }
  Material of_others = paper_pmma();
  of_others.density_kg_m3 = {1.1 * shots[0].bench.input.density_kg_m3};
  CalibrationOptions with_others;
  with_others.bars = BarPrior(of_others);
  EXPECT_THROW((void)calibrate(shots, with_others), InputError);
  shots[1].bench_toml += "\n# another\n";
  EXPECT_THROW((void)calibrate(shots, {}), InputError);
}

}  // namespace
}  // namespace kolsky
