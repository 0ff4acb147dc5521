// A channel that is recorded late, by benches that know nothing of it, know it, or know by how much
// it may be. Records are made in the time domain and read at another time.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "processing/calibration/calibration.hpp"
#include "processing/criticism/verdict/diagnosis.hpp"
#include "processing/identification/bar_fit.hpp"
#include "processing/identification/parameter_budget.hpp"
#include "processing/reduction/reducer.hpp"
#include "processing/specimen/specimen_fit.hpp"
#include "tests/generators/campaign.hpp"
#include "tests/unit/criticism/filed_bars.hpp"

namespace kolsky {
namespace {

constexpr double kLate_s = 1.7e-6;
constexpr std::size_t kGauge = 1;

testing::Campaign late_bar(int gauges) {
  testing::Campaign made = testing::draw_campaign(
      {.seed = 5, .shots = 6, .gauges = gauges, .samples = 1500, .rate_Hz = 1e6});
  testing::hide(made, testing::parse_effect("channel-delay:g2=1.7e-6"));
  return made;
}

testing::Campaign split_bar(double noise_strain) {
  return testing::draw_campaign({.seed = 6,
                                 .shots = 4,
                                 .gauges = 2,
                                 .noise_strain = noise_strain,
                                 .bits = 0,
                                 .samples = 1400,
                                 .rate_Hz = 1e6,
                                 .split = true});
}

testing::Campaign late_split_bar(double noise_strain) {
  testing::Campaign made = split_bar(noise_strain);
  testing::hide(made, testing::parse_effect("channel-delay:g2=1.7e-6"));
  return made;
}

std::vector<Shot> filed_with(const testing::Campaign& made, Measured delay_s) {
  std::vector<Shot> shots = testing::shots_of(made);
  for (Shot& shot : shots) {
    shot.bench.gauges[kGauge].delay_s = delay_s;
  }
  return shots;
}

BarFit fitted(const testing::Campaign& made, Measured delay_s) {
  return fit_bar(filed_with(made, delay_s), {.theory = WaveTheory::elementary});
}

FittedNumber fitted_E1(const testing::Campaign& made, Measured delay_s) {
  return fitted(made, delay_s).parameters.front();
}

// With two gauges all of a delay is in the wave speed.
TEST(FiledDelay, OfABarIsOutOfItsModulus) {
  const testing::Campaign made = late_bar(2);
  const double truth_Pa = made.world.material.E1_Pa;
  const FittedNumber unknown = fitted_E1(made, {});
  const FittedNumber known = fitted_E1(made, {kLate_s, 0.0});
  EXPECT_GT(std::abs(unknown.value - truth_Pa), 20.0 * unknown.sd);
  EXPECT_NEAR(known.value, truth_Pa, 3.0 * known.sd);
  EXPECT_NEAR(known.sd, unknown.sd, 0.1 * unknown.sd);
}

TEST(FiledDelay, WithADeviationWidensThatOfTheModulus) {
  const testing::Campaign made = late_bar(2);
  const double truth_Pa = made.world.material.E1_Pa;
  const FittedNumber exact = fitted_E1(made, {});
  const BarFit fit = fitted(made, {0.0, 1e-6});
  const FittedNumber doubtful = fit.parameters.front();
  EXPECT_NEAR(doubtful.value, truth_Pa, 3.0 * doubtful.sd);
  EXPECT_GT(std::abs(doubtful.value - truth_Pa), doubtful.sd);  // 1.7 deviations
  EXPECT_GT(doubtful.sd, 10.0 * exact.sd);
  const auto budget = parameter_budget(fit.parameters, fit.by_bench, fit.bench);
  EXPECT_EQ(budget.front().source, "channel delays");
}

Diagnosis diagnosed(const testing::Campaign& made, Measured delay_s) {
  const Campaign campaign = read_campaign(filed_with(made, delay_s));
  Study study(campaign, 0.0, Workers{});
  return diagnose(study, paper_model(BenchKind::bar, false), {});
}

TEST(FiledDelay, IsNoEffectThatIsMissing) {
  const testing::Campaign made = late_bar(4);
  const Diagnosis unknown = diagnosed(made, {});
  EXPECT_EQ(name_of(unknown.verdict), "named");
  ASSERT_FALSE(unknown.effects.empty());
  EXPECT_EQ(unknown.effects.front(), "channel-delay:g2");
  EXPECT_EQ(name_of(diagnosed(made, {kLate_s, 0.0}).verdict), "adequate");
  EXPECT_EQ(name_of(diagnosed(made, {0.0, 1e-6}).verdict), "adequate");
  // Eight deviations off what is filed is beyond what was thought possible.
  EXPECT_EQ(name_of(diagnosed(made, {0.0, 0.2e-6}).verdict), "named");
}

TEST(FiledDelay, IsOutOfAReducedShot) {
  constexpr double kHardlyAny_strain = 0.02e-6;
  const testing::Campaign made = late_split_bar(kHardlyAny_strain);
  const std::vector<Shot> late = filed_with(made, {});
  const std::vector<Shot> filed = filed_with(made, {kLate_s, 0.0});
  const std::vector<Shot> on_time = testing::shots_of(split_bar(kHardlyAny_strain));
  Reducer reducer;
  const auto history = [&](Shot shot) {
    shot.bar_model = made.filed_bars;
    return reducer.reduce(shot).force_back_N;
  };
  const auto apart = [&](const std::vector<double>& a, const std::vector<double>& b) {
    double most = 0.0;
    for (std::size_t n = 0; n < std::min(a.size(), b.size()); ++n) {
      most = std::max(most, std::abs(a[n] - b[n]));
    }
    return most;
  };
  const std::vector<double> truth_N = history(on_time.front());
  EXPECT_LT(apart(history(filed.front()), truth_N), 0.05 * apart(history(late.front()), truth_N));
}

TEST(FiledDelay, OfASplitBarIsOutOfTheSpecimensModuli) {
  const testing::Campaign made = late_split_bar(4e-6);
  const double truth_Pa = made.split->specimen.E1_Pa;
  const BarPrior bars(*made.filed_bars);
  const auto E1 = [&](Measured delay_s) {
    return fit_specimen(filed_with(made, delay_s), bars, {}).parameters.front();
  };
  const FittedNumber unknown = E1({});
  const FittedNumber known = E1({kLate_s, 0.0});
  const FittedNumber doubtful = E1({0.0, 1e-6});
  EXPECT_GT(std::abs(unknown.value - truth_Pa), 5.0 * unknown.sd);
  EXPECT_NEAR(known.value, truth_Pa, 3.0 * known.sd);
  EXPECT_NEAR(doubtful.value, truth_Pa, 3.0 * doubtful.sd);
  EXPECT_GT(doubtful.sd, 1.5 * known.sd);
}

TEST(FiledDelay, IsHeldAgainstCalibrationShots) {
  testing::Campaign made = late_bar(4);
  testing::hide(made, testing::parse_effect("end-reflection=0"));
  const auto number = [&](Measured delay_s) {
    const Calibration calibration = calibrate(filed_with(made, delay_s), {});
    const auto& numbers = calibration.parts.front().numbers;
    return *std::find_if(numbers.begin(), numbers.end(),
                         [](const auto& n) { return n.id == "channel-delay:g2"; });
  };
  const CalibratedNumber right = number({kLate_s, 0.2e-6});
  EXPECT_EQ(right.standing, Standing::agrees);
  EXPECT_NEAR(right.measured.value, kLate_s, 4.0 * right.measured.sd);
  const CalibratedNumber wrong = number({-kLate_s, 0.2e-6});
  EXPECT_EQ(wrong.standing, Standing::differs);
  EXPECT_NEAR(wrong.measured.value, kLate_s, 4.0 * wrong.measured.sd);
}

}  // namespace
}  // namespace kolsky
