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

TEST(Shot, CutAtATimeKeepsWhatIsBefore) {
  Shot shot;
  shot.rate = SampleRate::from_Hz(1e6);
  shot.first_tick = 100;
  shot.channels.resize(2);
  shot.channels[0].codes = {1, 2, 3, 4};
  shot.channels[1].codes = {5, 6, 7, 8};
  shot.gaps = {{101, 1, true}, {103, 2, true}};
  cut_at(shot, 3e-6);
  EXPECT_EQ(shot.channels[0].codes, (std::vector<std::int32_t>{1, 2, 3}));
  EXPECT_EQ(shot.channels[1].codes, (std::vector<std::int32_t>{5, 6, 7}));
  EXPECT_EQ(shot.gaps, (std::vector<Gap>{{101, 1, true}}));
  cut_at(shot, 1.0);
  EXPECT_EQ(shot.samples(), 3U);
}

}  // namespace
}  // namespace kolsky
