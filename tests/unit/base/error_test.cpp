#include "processing/base/error.hpp"

#include <gtest/gtest.h>

namespace kolsky {
namespace {

TEST(InputError, IsOneLineOfPlaceWhatAndMend) {
  const InputError error("gauges[1].position_m", "is off the bar", "give metres");
  EXPECT_STREQ(error.what(), "gauges[1].position_m: is off the bar; give metres");
  EXPECT_EQ(error.place(), "gauges[1].position_m");
  EXPECT_EQ(error.problem(), "is off the bar");
  EXPECT_EQ(error.mend(), "give metres");
}

TEST(InputError, StaysOneLineWhateverItQuotes) {
  const InputError error("a\nb", "is \"\x1B[2J\r\"", "mend it");
  EXPECT_STREQ(error.what(), "a\\nb: is \"\\x1b[2J\\x0d\"; mend it");
  EXPECT_EQ(error.place(), "a\nb");
}

TEST(InputError, IsSeenFromFurtherOut) {
  const InputError error =
      InputError("key", "is wrong", "mend it").inside("file.toml").inside("folder");
  EXPECT_STREQ(error.what(), "folder: file.toml: key: is wrong; mend it");
  EXPECT_EQ(error.place(), "folder: file.toml: key");
}

}  // namespace
}  // namespace kolsky
