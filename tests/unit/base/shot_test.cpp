#include "processing/base/shot.hpp"

#include <gtest/gtest.h>

namespace kolsky {
namespace {

TEST(ChannelRecord, ValueIsCodePlusOffsetTimesScale) {
  ChannelRecord channel;
  channel.scale = 0.25;
  channel.offset = -2.0;
  EXPECT_EQ(channel.value(10), 2.0);
  EXPECT_EQ(channel.value(-6), -2.0);
}

TEST(ChannelRecord, ClippedAreTheCodesAtTheEndsAndBeyond) {
  ChannelRecord channel;
  channel.code_min = -4;
  channel.code_max = 3;
  channel.codes = {-5, -4, -3, 0, 2, 3, 4};
  EXPECT_EQ(clipped_samples(channel), (std::vector<std::size_t>{0, 1, 5, 6}));
  channel.codes = {-3, 2};
  EXPECT_TRUE(clipped_samples(channel).empty());
}

TEST(Shot, HasAsManySamplesAsItsChannels) {
  Shot shot;
  EXPECT_EQ(shot.samples(), 0U);
  shot.channels.resize(2);
  shot.channels[0].codes = {1, 2, 3};
  EXPECT_EQ(shot.samples(), 3U);
}

}  // namespace
}  // namespace kolsky
