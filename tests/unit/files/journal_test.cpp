#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstring>
#include <fstream>
#include <random>
#include <thread>

#include "drivers/files/store/journal.hpp"
#include "drivers/files/store/journal_record.hpp"
#include "tests/scratch_folder.hpp"
#include "tests/unit/files/stored_shots.hpp"

namespace kolsky {
namespace {

using testing::bytes_of;
using testing::expect_refused;
using testing::expect_same;
using testing::make_shot;
using testing::ScratchFolder;
using testing::write_bytes;

TEST(Journal, GivesBackWhatWasAppended) {
  const ScratchFolder folder;
  {
    Journal journal(folder / "a.kj");
    journal.append_shot(make_shot(1));
    journal.append_stored("shot-1", "shots/shot-1.h5");
    journal.append_shot(make_shot(2, {4, 100, 24}));
  }
  const auto contents = read_journal(folder / "a.kj");
  ASSERT_EQ(contents.shots.size(), 2U);
  expect_same(contents.shots[0], make_shot(1));
  expect_same(contents.shots[1], make_shot(2, {4, 100, 24}));
  EXPECT_EQ(contents.shots[1].bench.gauges.size(), 4U);
  ASSERT_EQ(contents.stored.size(), 1U);
  EXPECT_EQ(contents.stored[0].shot_id, "shot-1");
  EXPECT_EQ(contents.stored[0].capture, "shots/shot-1.h5");
  EXPECT_EQ(contents.whole_records, 4U);  // with the one that opens it
  EXPECT_EQ(contents.bytes_ignored, 0U);
  EXPECT_TRUE(contents.problems.empty());
}

TEST(Journal, CanBeReadWhileItIsWritten) {
  const ScratchFolder folder;
  Journal journal(folder / "a.kj");
  EXPECT_TRUE(read_journal(folder / "a.kj").shots.empty());
  journal.append_shot(make_shot(1));
  const auto contents = read_journal(folder / "a.kj");
  EXPECT_EQ(contents.shots.size(), 1U);
  EXPECT_EQ(contents.bytes_ignored, 0U);
  EXPECT_TRUE(contents.problems.empty());
}

TEST(Journal, GivesTheRoomAheadBack) {
  const ScratchFolder folder;
  std::uintmax_t open_size = 0;
  {
    Journal journal(folder / "a.kj");
    journal.append_shot(make_shot(1));
    open_size = std::filesystem::file_size(folder / "a.kj");
  }
  EXPECT_GE(open_size, 500'000U);
  EXPECT_LT(std::filesystem::file_size(folder / "a.kj"), 8000U);
}

TEST(Journal, NeverTakesAnExistingFile) {
  const ScratchFolder folder;
  std::ofstream(folder / "a.kj") << "mine";
  expect_refused([&] { const Journal journal(folder / "a.kj"); }, {"a.kj", "exists"});
  EXPECT_EQ(bytes_of(folder / "a.kj").size(), 4U);
  expect_refused([&] { const Journal journal(folder / "no/a.kj"); }, {"no/a.kj"});
}

TEST(Journal, RefusesAShotThatCouldNeverBecomeACapture) {
  const ScratchFolder folder;
  Journal journal(folder / "a.kj");
  Shot bad = make_shot(1);
  bad.id = "../../etc/cron.d/x";
  expect_refused([&] { journal.append_shot(bad); }, {"id"});
  journal.append_shot(make_shot(2));
  EXPECT_EQ(read_journal(folder / "a.kj").shots.size(), 1U);
}

TEST(Journal, TakesRecordsLargerThanTheRoomAhead) {
  const ScratchFolder folder;
  const testing::ShotShape large{4, 1'000'000, 16};
  {
    Journal journal(folder / "a.kj");
    journal.append_shot(make_shot(1));
    journal.append_shot(make_shot(2, large));
    journal.append_shot(make_shot(3));
  }
  const auto contents = read_journal(folder / "a.kj");
  ASSERT_EQ(contents.shots.size(), 3U);
  EXPECT_EQ(contents.shots[1].channels, make_shot(2, large).channels);
  expect_same(contents.shots[2], make_shot(3));
}

TEST(Journal, TwoThreadsMayAppend) {
  const ScratchFolder folder;
  constexpr std::uint32_t kShots = 60;
  {
    Journal journal(folder / "a.kj");
    std::thread storing([&journal] {
      for (std::uint32_t i = 0; i < 500; ++i) {
        journal.append_stored("shot-" + std::to_string(i), "x.h5");
      }
    });
    for (std::uint32_t i = 0; i < kShots; ++i) {
      journal.append_shot(make_shot(i, {2, 30'000}));  // 7 MB: past the first room
    }
    storing.join();
  }
  const auto contents = read_journal(folder / "a.kj");
  EXPECT_EQ(contents.shots.size(), kShots);
  EXPECT_EQ(contents.stored.size(), 500U);
  EXPECT_TRUE(contents.problems.empty());
  EXPECT_EQ(contents.bytes_ignored, 0U);
}

/// A closed journal of three shots, and where its records begin.
class DamagedJournal : public ::testing::Test {
 protected:
  DamagedJournal() {
    {
      Journal journal(whole_);
      for (std::uint32_t i = 0; i < 3; ++i) {
        journal.append_shot(make_shot(i, {2, 60}));
      }
    }
    bytes_ = bytes_of(whole_);
    for (std::size_t at = 0; at < bytes_.size();) {
      starts_.push_back(at);
      const auto header = journal_record::parse_header(
          std::span<const std::byte, 32>(bytes_.data() + at, journal_record::kHeaderBytes));
      at += static_cast<std::size_t>(header.value().record_bytes());
    }
    EXPECT_EQ(starts_.size(), 4U);
  }

  [[nodiscard]] JournalContents read(const std::vector<std::byte>& bytes) const {
    write_bytes(path_, bytes);
    return read_journal(path_);
  }
  [[nodiscard]] std::vector<std::byte> first(std::size_t count) const {
    return {bytes_.begin(), bytes_.begin() + static_cast<std::ptrdiff_t>(count)};
  }

  ScratchFolder folder_;
  std::filesystem::path whole_ = folder_ / "whole.kj";
  std::filesystem::path path_ = folder_ / "damaged.kj";
  std::vector<std::byte> bytes_;
  std::vector<std::size_t> starts_;
};

TEST_F(DamagedJournal, AnyTornEndIsIgnoredAndCounted) {
  for (std::size_t length = starts_[3] + journal_record::kHeaderBytes; length < bytes_.size();
       length += 7) {
    const auto torn = read(first(length));
    ASSERT_EQ(torn.shots.size(), 2U) << length;
    EXPECT_TRUE(torn.problems.empty()) << length;
    EXPECT_LE(torn.bytes_ignored, length - starts_[3]);
    EXPECT_GE(torn.bytes_ignored, journal_record::kHeaderBytes);
    expect_same(torn.shots[1], make_shot(1, {2, 60}));
  }
}

TEST_F(DamagedJournal, ATornEndBeforeTheRoomAheadIsIgnoredAndCounted) {
  for (std::size_t length = starts_[3]; length < bytes_.size() - 8; length += 13) {
    auto torn_bytes = first(length);
    torn_bytes.resize(std::size_t{1} << 17U);
    const auto torn = read(torn_bytes);
    ASSERT_EQ(torn.shots.size(), 2U) << length;
    if (length >= starts_[3] + journal_record::kHeaderBytes) {
      EXPECT_TRUE(torn.problems.empty()) << length << torn.problems.front().text;
    }
    EXPECT_EQ(torn.whole_records, 3U);
  }
}

// What a power cut may leave: the disk wrote a later sector but not the first.
TEST_F(DamagedJournal, AnEndWithoutItsHeaderIsIgnoredAndCounted) {
  auto bytes = bytes_;
  std::fill(bytes.begin() + static_cast<std::ptrdiff_t>(starts_[3]),
            bytes.begin() + static_cast<std::ptrdiff_t>(starts_[3] + 512), std::byte{0});
  const auto contents = read(bytes);
  EXPECT_EQ(contents.shots.size(), 2U);
  EXPECT_EQ(contents.bytes_ignored, bytes_.size() - starts_[3]);
  EXPECT_TRUE(contents.problems.empty());
}

TEST_F(DamagedJournal, AnyFlippedBitIsReportedAndCostsOneRecord) {
  std::mt19937 random(1);
  for (int i = 0; i < 500; ++i) {
    auto bytes = bytes_;
    const std::size_t position = random() % bytes.size();
    bytes[position] ^= static_cast<std::byte>(1U << (random() % 8));
    const auto contents = read(bytes);
    ASSERT_EQ(contents.problems.size(), 1U) << "at byte " << position;
    const auto next = std::upper_bound(starts_.begin(), starts_.end(), position);
    const auto record = static_cast<std::size_t>(next - starts_.begin()) - 1;
    EXPECT_EQ(contents.problems[0].offset, starts_[record]);
    ASSERT_EQ(contents.shots.size(), record == 0 ? 3U : 2U) << "at byte " << position;
    for (std::size_t k = 0, shot = 0; k < 3; ++k) {
      if (k + 1 != record) {
        EXPECT_EQ(contents.shots[shot++].channels,
                  make_shot(static_cast<std::uint32_t>(k), {2, 60}).channels);
      }
    }
  }
}

TEST_F(DamagedJournal, ARecordLostFromTheMiddleIsReported) {
  auto bytes = bytes_;
  std::fill(bytes.begin() + static_cast<std::ptrdiff_t>(starts_[2]),
            bytes.begin() + static_cast<std::ptrdiff_t>(starts_[3]), std::byte{0});
  const auto contents = read(bytes);
  EXPECT_EQ(contents.shots.size(), 2U);
  ASSERT_EQ(contents.problems.size(), 1U);
  EXPECT_EQ(contents.problems[0].offset, starts_[2]);
}

TEST_F(DamagedJournal, GarbageBehindTheLastRecordIsReported) {
  auto bytes = bytes_;
  for (int i = 0; i < 100; ++i) {
    bytes.push_back(std::byte{'x'});
  }
  const auto contents = read(bytes);
  EXPECT_EQ(contents.shots.size(), 3U);
  ASSERT_EQ(contents.problems.size(), 1U);
  EXPECT_EQ(contents.problems[0].offset, bytes_.size());
}

TEST_F(DamagedJournal, ATruthfulHeaderOfAnAbsurdLengthIsCutShort) {
  std::vector<std::byte> record;
  journal_record::begin(record);
  journal_record::finish(journal_record::Kind::shot, record);
  const std::uint64_t length = std::uint64_t{1} << 61U;
  std::memcpy(record.data() + 8, &length, sizeof length);
  // Its own checksum is the only thing that makes a header believable.
  EXPECT_FALSE(journal_record::parse_header(std::span<const std::byte, 32>(record.data(), 32)));
  auto bytes = bytes_;
  bytes.insert(bytes.end(), record.begin(), record.end());
  EXPECT_EQ(read(bytes).shots.size(), 3U);
  EXPECT_EQ(read(bytes).problems.size(), 1U);
}

TEST_F(DamagedJournal, AWholeRecordThatHoldsNoShotIsReported) {
  std::vector<std::byte> record;
  journal_record::begin(record);
  record.resize(record.size() + 100, std::byte{1});
  journal_record::finish(journal_record::Kind::shot, record);
  auto bytes = bytes_;
  bytes.insert(bytes.end(), record.begin(), record.end());
  const auto contents = read(bytes);
  EXPECT_EQ(contents.shots.size(), 3U);
  ASSERT_EQ(contents.problems.size(), 1U);
  EXPECT_NE(contents.problems[0].text.find("format"), std::string::npos);
}

TEST(NoJournal, IsRefused) {
  const ScratchFolder folder;
  std::ofstream(folder / "text.kj") << "no journal at all";
  std::ofstream(folder / "long.kj") << std::string(100'000, 'K');
  std::filesystem::create_directory(folder / "folder.kj");
  expect_refused([&] { (void)read_journal(folder / "text.kj"); }, {"text.kj", "is not a journal"});
  expect_refused([&] { (void)read_journal(folder / "long.kj"); }, {"long.kj", "is not a journal"});
  expect_refused([&] { (void)read_journal(folder / "folder.kj"); }, {"folder.kj"});
  expect_refused([&] { (void)read_journal(folder / "gone.kj"); }, {"gone.kj", "No such file"});
}

TEST(NoJournal, AFileThatACrashLeftEmptyIsAnEmptyJournal) {
  const ScratchFolder folder;
  write_bytes(folder / "a.kj", {});
  write_bytes(folder / "b.kj", std::vector<std::byte>(100'000));
  for (const char* name : {"a.kj", "b.kj"}) {
    const auto contents = read_journal(folder / name);
    EXPECT_EQ(contents.whole_records, 0U);
    EXPECT_TRUE(contents.problems.empty());
  }
}

TEST(NoJournal, ALaterFormatIsRefused) {
  const ScratchFolder folder;
  std::vector<std::byte> record;
  journal_record::begin(record);
  record.resize(record.size() + 8, std::byte{0});
  record[journal_record::kHeaderBytes] = std::byte{2};
  journal_record::finish(journal_record::Kind::opened, record);
  write_bytes(folder / "a.kj", record);
  expect_refused([&] { (void)read_journal(folder / "a.kj"); }, {"a.kj", "format 2"});
}

// A file-size limit stands in for a full disk: what was appended stays whole, and the journal goes
// on when there is space again.
TEST(Journal, AFullDiskCostsNothingAppended) {
  const ScratchFolder folder;
  const pid_t child = ::fork();
  if (child == 0) {
    ::signal(SIGXFSZ, SIG_IGN);
    const rlimit limit{5'000'000, RLIM_INFINITY};
    ::setrlimit(RLIMIT_FSIZE, &limit);
    Journal journal(folder / "a.kj");
    std::uint32_t appended = 0;
    try {
      for (; appended < 100; ++appended) {
        journal.append_shot(make_shot(appended, {2, 30'000}));
      }
    } catch (const std::runtime_error&) {
      const rlimit space{RLIM_INFINITY, RLIM_INFINITY};
      ::setrlimit(RLIMIT_FSIZE, &space);
      journal.append_shot(make_shot(1000));
      ::_exit(static_cast<int>(appended));
    }
    ::_exit(0);
  }
  int status = 0;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  ASSERT_TRUE(WIFEXITED(status));
  const auto contents = read_journal(folder / "a.kj");
  EXPECT_GE(WEXITSTATUS(status), 30);
  ASSERT_EQ(contents.shots.size(), static_cast<std::size_t>(WEXITSTATUS(status)) + 1);
  expect_same(contents.shots.back(), make_shot(1000));
  EXPECT_TRUE(contents.problems.empty());
}

}  // namespace
}  // namespace kolsky
