#include <gtest/gtest.h>

#include "tests/unit/simulated/served_ramp.hpp"

namespace kolsky::testing {
namespace {

using std::chrono::nanoseconds;

// A block that is due without being there would go out as an empty first chunk, and what follows it
// without the head that the client expects: the stream is out of step for good.
TEST(AdcStream, HoldsItsBlockAsSoonAsItIsDueAndNotBefore) {
  constexpr Tick kBlock = 100;
  SimulatedAdc adc(ramp_settings(1.0), std::make_unique<RampSource>());
  std::unique_ptr<AdcStream> stream;
  ASSERT_EQ(adc.open_stream({0x3}, kBlock, stream), 0);
  std::vector<std::byte> scans(kBlock * stream->layout().bytes());
  for (int block = 0; block < 20; ++block) {
    const auto due = stream->due(SimulatedAdc::Clock::time_point::min());
    const auto before = due - nanoseconds(1);
    EXPECT_GT(stream->due(before), before);
    EXPECT_EQ(stream->available(), 0U);
    EXPECT_LE(stream->due(due), due);
    ASSERT_EQ(stream->available(), static_cast<std::size_t>(kBlock));
    stream->read(scans);
  }
}

TEST(AdcStream, IsDueLaterByWhatTheScriptLoses) {
  SimulatedAdc adc(ramp_settings(1.0, "time 500ms lose 50"), std::make_unique<RampSource>());
  std::unique_ptr<AdcStream> stream;
  ASSERT_EQ(adc.open_stream({0x1}, 1'000'000, stream), 0);
  const auto due = stream->due(SimulatedAdc::Clock::time_point::min());
  const auto rate_Hz = adc.settings().rate.Hz();
  const std::chrono::duration<double> later = stream->due(due) - due;
  EXPECT_NEAR(later.count() * rate_Hz, 50.0, 1e-2);
}

}  // namespace
}  // namespace kolsky::testing
