// A digitiser whose clock is off, by benches that take it for exact or file a deviation. Records
// are made in the time domain at one rate and said to be at another.
#include <gtest/gtest.h>

#include "processing/criticism/verdict/diagnosis.hpp"
#include "tests/generators/campaign.hpp"

namespace kolsky {
namespace {

constexpr double kFast = 3e-3;  ///< by how much less than filed the true rate is

Campaign with_clock(bool split, double off, double relative_sd) {
  const testing::Campaign made = testing::draw_campaign({.seed = 11,
                                                         .shots = 6,
                                                         .gauges = 3,
                                                         .samples = 1500,
                                                         .rate_Hz = 1e6,
                                                         .split = split,
                                                         .elastic = true});
  std::vector<Shot> shots = testing::shots_of(made);
  for (Shot& shot : shots) {
    const double said_Hz = 1e6 * (1.0 + off);
    shot.rate = SampleRate::from_Hz(said_Hz);
    shot.bench.sampling_frequency_Hz = {said_Hz, relative_sd * said_Hz};
  }
  return read_campaign(shots);
}

class FiledClock : public ::testing::TestWithParam<bool> {
 protected:
  [[nodiscard]] Studied fitted(double off, double relative_sd) const {
    const Campaign campaign = with_clock(GetParam(), off, relative_sd);
    Study study(campaign, 0.0, Workers{});
    return study.fit(paper_model(GetParam() ? BenchKind::shpb : BenchKind::bar, true));
  }
};

// Of an elastic bar whose modulus is filed as exact nothing else takes the place of time.
TEST_P(FiledClock, IsFoundWithinWhatIsFiled) {
  const Studied off = fitted(kFast, kFast);
  const ModelValue& delta = off.model.find("sampling-clock")->values[0];
  EXPECT_NEAR(delta.value, 1.0 / (1.0 + kFast) - 1.0, 3.0 * delta.sd);
  EXPECT_LT(delta.sd, 0.1 * kFast);
  const Studied exact = fitted(kFast, 0.0);
  EXPECT_LT(off.misfit.chi2_reduced, 1.1);
  EXPECT_GT(exact.misfit.chi2_reduced, 2.0);
}

TEST_P(FiledClock, ThatIsRightIsLeftThere) {
  const Studied right = fitted(0.0, kFast);
  const ModelValue& delta = right.model.find("sampling-clock")->values[0];
  EXPECT_NEAR(delta.value, 0.0, 3.0 * delta.sd);
  EXPECT_LT(right.misfit.chi2_reduced, 1.1);
}

INSTANTIATE_TEST_SUITE_P(Benches, FiledClock, ::testing::Bool(),
                         [](const auto& bench) { return bench.param ? "SplitBar" : "Bar"; });

}  // namespace
}  // namespace kolsky
