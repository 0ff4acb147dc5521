#include "clients/cli/reports/share_text.hpp"

#include <gtest/gtest.h>

namespace kolsky::cli {
namespace {

TEST(ShareText, HasTwoDigitsAndNoExponentFromAHundredOn) {
  EXPECT_EQ(share_text(0.0), "0 %");
  EXPECT_EQ(share_text(2.53e-6), "0.00025 %");
  EXPECT_EQ(share_text(0.0981), "9.8 %");
  EXPECT_EQ(share_text(0.994), "99 %");
  EXPECT_EQ(share_text(0.996), "100 %");
  EXPECT_EQ(share_text(4.21), "421 %");
}

}  // namespace
}  // namespace kolsky::cli
