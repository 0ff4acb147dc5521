#include "clients/cli/slow_work.hpp"

#include <gtest/gtest.h>

namespace kolsky::cli {
namespace {

std::string told(std::chrono::milliseconds every) {
  ::testing::internal::CaptureStderr();
  SlowWork work("kolsky calibrate", every);
  work.at("all 16 numbers as filed");
  work.at("with gauge-factor:g1 free");
  return ::testing::internal::GetCapturedStderr();
}

TEST(SlowWork, TellsWhatIsAtHand) {
  EXPECT_EQ(told(std::chrono::milliseconds(0)),
            "kolsky calibrate: all 16 numbers as filed\n"
            "kolsky calibrate: with gauge-factor:g1 free\n");
}

TEST(SlowWork, IsSilentWhereWorkIsQuick) {
  EXPECT_EQ(told(std::chrono::hours(1)), "");
}

}  // namespace
}  // namespace kolsky::cli
