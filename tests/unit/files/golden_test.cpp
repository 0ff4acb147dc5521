#include <algorithm>
#include <cstring>

#include "drivers/files/captures/capture.hpp"
#include "drivers/files/captures/shot_codec.hpp"
#include "drivers/files/store/journal.hpp"
#include "tests/unit/files/stored_shots.hpp"

namespace kolsky {
namespace {

const std::filesystem::path kFolder = KOLSKY_SOURCE_DIR "/tests/unit/files/golden";

// Files of every version of an encoded shot, kept as they were written: whatever comes later has to
// read them.
class Golden : public ::testing::TestWithParam<testing::GoldenShot> {
 protected:
  [[nodiscard]] static const Shot& shot() { return GetParam().shot; }
  [[nodiscard]] static std::filesystem::path file(const char* extension) {
    return kFolder / (GetParam().name + extension);
  }
};

TEST_P(Golden, AnOldCaptureIsRead) {
  testing::expect_same(read_capture(file(".h5")), shot());
}

TEST_P(Golden, AnOldJournalIsRead) {
  const auto contents = read_journal(file(".kj"));
  ASSERT_EQ(contents.shots.size(), 1U);
  testing::expect_same(contents.shots[0], shot());
  ASSERT_EQ(contents.stored.size(), 1U);
  EXPECT_EQ(contents.stored[0].capture, shot().id + ".h5");
  EXPECT_EQ(contents.whole_records, 3U);
}

// Checksums of the metadata stand in stored captures.
TEST_P(Golden, AShotIsEncodedAsItWas) {
  std::vector<std::byte> encoded;
  encode_shot(shot(), encoded);
  std::uint32_t version = 0;
  std::memcpy(&version, encoded.data(), sizeof version);
  EXPECT_EQ(version, GetParam().version);
  const auto journal = testing::bytes_of(file(".kj"));
  EXPECT_FALSE(std::ranges::search(journal, encoded).empty());
}

INSTANTIATE_TEST_SUITE_P(Versions, Golden, ::testing::ValuesIn(testing::make_golden_shots()),
                         [](const auto& tested) { return tested.param.name; });

}  // namespace
}  // namespace kolsky
