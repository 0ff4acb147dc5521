#include "drivers/files/captures/capture.hpp"
#include "drivers/files/store/journal.hpp"
#include "tests/unit/files/stored_shots.hpp"

namespace kolsky {
namespace {

const std::filesystem::path kFolder = KOLSKY_SOURCE_DIR "/tests/unit/files/golden";

// Files of format 1, kept as they were written: whatever comes later has to read them.
TEST(Golden, AnOldCaptureIsRead) {
  testing::expect_same(read_capture(kFolder / "shot.h5"), testing::make_golden_shot());
}

TEST(Golden, AnOldJournalIsRead) {
  const auto contents = read_journal(kFolder / "shot.kj");
  ASSERT_EQ(contents.shots.size(), 1U);
  testing::expect_same(contents.shots[0], testing::make_golden_shot());
  ASSERT_EQ(contents.stored.size(), 1U);
  EXPECT_EQ(contents.stored[0].capture, "golden-1.h5");
  EXPECT_EQ(contents.whole_records, 3U);
}

}  // namespace
}  // namespace kolsky
