#include "processing/criticism/impact/quiet_before.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "processing/criticism/impact/impact_diagnosis.hpp"
#include "tests/unit/criticism/thrown_balls.hpp"

namespace kolsky {
namespace {

using testing::paper_with;
using testing::ThrownBalls;

/// Impacts at one speed with something added to the records, by time from just before the gauge
/// sees the pulse.
template <typename Added>
std::vector<Shot> thrown_with(const Added& added) {
  testing::ImpactWishes own = testing::two_speeds(23, 3);
  own.speeds_m_per_s = {40.3};
  std::vector<Shot> shots = testing::impact_shots(own);
  for (Shot& shot : shots) {
    constexpr double kSeen_s = 440e-6;  // the touch at 400 us, the gauge 49 us away
    ChannelRecord& record = shot.channels[0];
    for (std::size_t i = 0; i < shot.samples(); ++i) {
      const double more = added(static_cast<double>(i) * 1e-6 - kSeen_s);
      record.codes[i] += static_cast<std::int32_t>(std::lround(more / record.scale));
    }
  }
  return shots;
}

double shifted(double time_s) {
  return time_s > 0.0 ? -2e-6 : 0.0;
}

double drifting(double time_s) {
  return 5e-3 * time_s;
}

bool drift_stands(double (*added)(double)) {
  ThrownBalls balls(thrown_with(added), {240, 512, 512});
  const Model model = paper_with({"baseline-drift:g1"});
  const Studied studied = balls.study.fit(model);
  return stands_before_pulse(studied, "baseline-drift:g1", balls.study.residuals());
}

TEST(QuietBefore, HoldsWhatDriftsAllAlong) {
  EXPECT_TRUE(drift_stands(drifting));
}

TEST(QuietBefore, DoesNotHoldWhatComesWithThePulse) {
  EXPECT_FALSE(drift_stands(shifted));
}

/// What the ball or the bar does is not in the quiet, and need not be.
TEST(QuietBefore, IsNotAskedForWhatImpactsDo) {
  ThrownBalls balls(thrown_with(shifted), {240, 512, 512});
  const Studied studied = balls.study.as_it_is(paper_with({"core-nonlinearity"}));
  EXPECT_TRUE(stands_before_pulse(studied, "core-nonlinearity", balls.study.residuals()));
}

/// A zero that moves as the pulse arrives is of no effect in the library; a hum or a drift of the
/// right slope stands for it in the pulse alone.
TEST(QuietBefore, AShiftOfZeroIsNeitherHumNorDrift) {
  ThrownBalls balls(thrown_with(shifted));
  const Diagnosis diagnosis = diagnose_impacts(balls.study, paper_with({}), {});
  for (const std::string& id : diagnosis.effects) {
    EXPECT_FALSE(id.starts_with("mains-hum") || id.starts_with("baseline-drift")) << id;
    for (const std::string& tied : diagnosis.tied_with.at(id)) {
      EXPECT_FALSE(tied.starts_with("mains-hum") || tied.starts_with("baseline-drift")) << tied;
    }
  }
  for (const char* id : {"mains-hum", "baseline-drift:g1"}) {
    const auto row = std::ranges::find(diagnosis.candidates, id, &CandidateResult::effect);
    EXPECT_EQ(row->verdict, CandidateVerdict::rejected) << id;
    EXPECT_TRUE(std::ranges::any_of(diagnosis.notes, [&](const std::string& note) {
      return note.starts_with(std::string(id) + " is not claimed: ");
    })) << id;
  }
}

}  // namespace
}  // namespace kolsky
