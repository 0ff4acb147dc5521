#include "daemon/shots/archivist.hpp"

#include <gtest/gtest.h>
#include <sqlite3.h>

#include <algorithm>
#include <fstream>
#include <mutex>
#include <optional>
#include <thread>

#include "daemon/shots/summary.hpp"
#include "drivers/files/captures/capture.hpp"
#include "tests/scratch_folder.hpp"
#include "tests/unit/files/full_disk.hpp"
#include "tests/unit/files/stored_shots.hpp"

namespace kolsky {
namespace {

using testing::expect_refused;
using testing::expect_same;
using testing::make_shot;
using testing::ScratchFolder;

constexpr std::chrono::seconds kPatience(20);

/// A store whose folders can be taken away and brought back, as a disk that is full for a while.
class ArchivistTest : public ::testing::Test {
 protected:
  ArchivistTest() { store_.create(); }

  void begin_only(std::chrono::milliseconds retry) {
    archivist_.reset();
    journal_.emplace(store_, ++boots_, 1U << 30U);
    archivist_ = std::make_unique<Archivist>(
        store_, *journal_,
        [this](const std::string& text) {
          const std::lock_guard lock(mutex_);
          faults_.push_back(text);
        },
        retry);
    archivist_->start();
  }
  /// With a catalogue that is complete.
  void begin(std::chrono::milliseconds retry = std::chrono::hours(1)) {
    begin_only(retry);
    (void)archivist_->newest(0);
  }
  void store(std::uint32_t seed, bool journaled = true) {
    const auto shot = std::make_shared<Shot>(make_shot(seed));
    if (journaled) {
      journal_->write_shot(*shot);
      journal_->make_durable(*shot);
    }
    archivist_->expect_shot();
    archivist_->store(shot, summarise(*shot, Reduction{}, ""));
  }
  void take_away(const std::filesystem::path& folder) const {
    std::filesystem::rename(folder, folder.string() + ".away");
  }
  void bring_back(const std::filesystem::path& folder) const {
    std::filesystem::rename(folder.string() + ".away", folder);
  }
  [[nodiscard]] std::vector<std::string> listed() {
    std::vector<std::string> ids;
    for (const CatalogueEntry& entry : archivist_->newest(0)) {
      ids.push_back(entry.id);
    }
    std::sort(ids.begin(), ids.end());
    return ids;
  }
  void damage(const std::string& id) const {
    std::filesystem::remove(store_.capture_of(id));
    std::ofstream(store_.capture_of(id)) << "no capture";
  }

  ScratchFolder folder_;
  StoreLayout store_{folder_ / "store"};
  std::uint64_t boots_ = 0;
  std::mutex mutex_;
  std::vector<std::string> faults_;
  std::optional<SharedJournal> journal_;
  std::unique_ptr<Archivist> archivist_;
};

TEST_F(ArchivistTest, FilesAJournaledShotAfterTheNextThatFindsRoom) {
  begin();
  take_away(store_.shots());
  store(1);
  store(2);
  expect_refused([&] { (void)archivist_->get("shot-1"); }, {"shot-1", "in the journal", "room"});
  EXPECT_TRUE(listed().empty());
  EXPECT_EQ(archivist_->failed(), 2U);
  bring_back(store_.shots());
  store(3);
  EXPECT_EQ(listed(), (std::vector<std::string>{"shot-1", "shot-2", "shot-3"}));
  expect_same(read_capture(store_.capture_of("shot-2")), make_shot(2));
  EXPECT_EQ(archivist_->stored(), 3U);
  EXPECT_EQ(faults_.size(), 2U);
}

TEST_F(ArchivistTest, FilesItByItselfInTime) {
  begin(std::chrono::milliseconds(20));
  take_away(store_.shots());
  store(1);
  EXPECT_TRUE(listed().empty());
  bring_back(store_.shots());
  const auto end = std::chrono::steady_clock::now() + kPatience;
  while (archivist_->stored() == 0 && std::chrono::steady_clock::now() < end) {
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  EXPECT_EQ(listed(), std::vector<std::string>{"shot-1"});
  EXPECT_EQ(faults_.size(), 1U) << "told once, not at each attempt";
}

TEST_F(ArchivistTest, KeepsAShotThatNoJournalHasInMemory) {
  begin();
  take_away(store_.shots());
  store(1, false);
  expect_refused([&] { (void)archivist_->get("shot-1"); }, {"in memory"});
  bring_back(store_.shots());
  archivist_->stop();
  expect_same(read_capture(store_.capture_of("shot-1")), make_shot(1));
}

TEST_F(ArchivistTest, HoldsNoDescriptorsForShotsThatFindNoRoom) {
  begin();
  store(1);
  EXPECT_EQ(listed().size(), 1U);
  const auto open_files = testing::entries_of("/proc/self/fd");
  {
    const testing::FullDisk disk(20'000);
    for (std::uint32_t i = 2; i < 6; ++i) {
      store(i);
    }
    EXPECT_EQ(listed().size(), 1U);
    EXPECT_EQ(testing::entries_of("/proc/self/fd"), open_files);
    EXPECT_EQ(testing::entries_of(store_.shots()), 1);
  }
  store(6);
  EXPECT_EQ(listed().size(), 6U);
}

TEST_F(ArchivistTest, EntersWhatTheCatalogueDoesNotKnowOneCaptureAtATime) {
  for (const std::uint32_t seed : {1U, 2U, 3U}) {
    write_capture(make_shot(seed), store_.capture_of("shot-" + std::to_string(seed)));
  }
  begin();
  EXPECT_EQ(listed(), (std::vector<std::string>{"shot-1", "shot-2", "shot-3"}));
  // The list of what is unknown, each of them, the word that all is there, and the two questions:
  // a watchdog sees every one.
  EXPECT_GE(archivist_->progress(), 6U);
}

TEST_F(ArchivistTest, CompletesTheCatalogueOnceNobodyElseHoldsIt) {
  begin();
  archivist_->stop();
  write_capture(make_shot(1), store_.capture_of("shot-1"));
  sqlite3* other = nullptr;
  ASSERT_EQ(sqlite3_open(store_.catalogue().c_str(), &other), SQLITE_OK);
  ASSERT_EQ(sqlite3_exec(other, "BEGIN EXCLUSIVE", nullptr, nullptr, nullptr), SQLITE_OK);
  begin_only(std::chrono::milliseconds(20));
  expect_refused([&] { (void)archivist_->newest(0); }, {"catalogue", "locked"});
  ASSERT_EQ(sqlite3_exec(other, "ROLLBACK", nullptr, nullptr, nullptr), SQLITE_OK);
  sqlite3_close(other);
  const auto end = std::chrono::steady_clock::now() + kPatience;
  while (listed().empty() && std::chrono::steady_clock::now() < end) {
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  EXPECT_EQ(listed(), std::vector<std::string>{"shot-1"});
  const std::lock_guard lock(mutex_);
  ASSERT_EQ(faults_.size(), 1U) << "told once, not at each attempt";
  EXPECT_NE(faults_[0].find("tried again"), std::string::npos);
}

TEST_F(ArchivistTest, AnswersNothingOnceItEnds) {
  begin();
  archivist_->stop();
  const auto before = std::chrono::steady_clock::now();
  expect_refused([&] { (void)archivist_->newest(0); }, {"ending"});
  EXPECT_LT(std::chrono::steady_clock::now() - before, std::chrono::seconds(5));
}

TEST_F(ArchivistTest, ListsADamagedCaptureAndSaysSo) {
  write_capture(make_shot(1), store_.capture_of("shot-1"));
  damage("20250117T102530123Z-89ef-0001");
  begin();
  EXPECT_EQ(listed(), (std::vector<std::string>{"20250117T102530123Z-89ef-0001", "shot-1"}));
  for (const CatalogueEntry& entry : archivist_->newest(0)) {
    if (entry.id == "shot-1") {
      EXPECT_FALSE(entry.verdict.empty());
      continue;
    }
    EXPECT_TRUE(entry.verdict.empty());
    EXPECT_FALSE(entry.reducible);
    EXPECT_NE(entry.reason.find("cannot be used"), std::string::npos) << entry.reason;
    EXPECT_EQ(entry.utc_ns, 1'737'109'530'123'000'000);  // date -u -d @1737109530
  }
  expect_refused([&] { (void)archivist_->get("20250117T102530123Z-89ef-0001"); },
                 {"not a capture"});
}

TEST_F(ArchivistTest, ListsAMissingCaptureAndTakesItBack) {
  write_capture(make_shot(1), store_.capture_of("shot-1"));
  begin();
  EXPECT_FALSE(archivist_->newest(0).at(0).verdict.empty());
  archivist_->stop();
  std::filesystem::rename(store_.capture_of("shot-1"), folder_ / "backup.h5");
  begin();
  EXPECT_TRUE(archivist_->newest(0).at(0).verdict.empty());
  EXPECT_EQ(archivist_->newest(0).at(0).reason, "its capture is missing");
  expect_refused([&] { (void)archivist_->get("shot-1"); }, {"shot-1.h5", "missing", "backup"});
  archivist_->stop();
  std::filesystem::rename(folder_ / "backup.h5", store_.capture_of("shot-1"));
  begin();
  EXPECT_FALSE(archivist_->newest(0).at(0).verdict.empty());
  expect_same(archivist_->get("shot-1").shot, make_shot(1));
}

}  // namespace
}  // namespace kolsky
