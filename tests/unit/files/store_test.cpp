#include "drivers/files/store/store.hpp"

#include <sys/file.h>

#include <fstream>

#include "drivers/files/captures/capture.hpp"
#include "drivers/files/captures/new_file.hpp"
#include "drivers/files/store/catalogue.hpp"
#include "drivers/files/store/journal.hpp"
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

class Store : public ::testing::Test {
 protected:
  Store() { layout_.create(); }

  void journal(const std::string& name, const std::vector<Shot>& shots) const {
    Journal file(layout_.journals() / name);
    for (const Shot& shot : shots) {
      file.append_shot(shot);
    }
  }
  void capture(const Shot& shot) const { write_capture(shot, layout_.capture_of(shot.id)); }

  ScratchFolder folder_;
  StoreLayout layout_{folder_ / "store"};
};

TEST_F(Store, AnEmptyStoreIsSound) {
  const auto report = verify_store(layout_);
  EXPECT_TRUE(report.problems.empty());
  EXPECT_EQ(report.journals + report.captures + report.journaled_shots, 0U);
}

TEST_F(Store, WhatIsJournaledAndCapturedIsSound) {
  journal("a.kj", {make_shot(1), make_shot(2)});
  journal("b.kj", {make_shot(3)});
  for (std::uint32_t i = 1; i <= 4; ++i) {
    capture(make_shot(i));  // the fourth one without a journal
  }
  const auto report = verify_store(layout_);
  EXPECT_TRUE(report.problems.empty());
  EXPECT_EQ(report.journals, 2U);
  EXPECT_EQ(report.journaled_shots, 3U);
  EXPECT_EQ(report.captures, 4U);
  EXPECT_TRUE(recover_store(layout_).recovered.empty());
}

TEST_F(Store, RecoveryWritesTheCapturesThatAreMissing) {
  journal("a.kj", {make_shot(1), make_shot(2), make_shot(3)});
  capture(make_shot(2));
  EXPECT_EQ(verify_store(layout_).problems.size(), 2U);
  const auto report = recover_store(layout_);
  EXPECT_TRUE(report.problems.empty());
  EXPECT_EQ(report.recovered, (std::vector<std::string>{"shot-1", "shot-3"}));
  EXPECT_EQ(report.captures, 3U);
  for (std::uint32_t i = 1; i <= 3; ++i) {
    expect_same(read_capture(layout_.capture_of("shot-" + std::to_string(i))), make_shot(i));
  }
  EXPECT_TRUE(verify_store(layout_).problems.empty());
  EXPECT_TRUE(recover_store(layout_).recovered.empty());
}

// Even where today's rules would refuse the bench: the samples come first.
TEST_F(Store, RecoveryNeedsNoReadableBench) {
  Shot shot = make_shot(1);
  shot.bench_toml = "kind = \"of another time\"";
  journal("a.kj", {shot});
  EXPECT_EQ(recover_store(layout_).recovered.size(), 1U);
  const auto report = verify_store(layout_);
  ASSERT_EQ(report.problems.size(), 1U);
  EXPECT_NE(report.problems[0].file.find("bench_toml"), std::string::npos);
}

TEST_F(Store, RecoveryRemovesWhatACrashLeftUnderATemporaryName) {
  journal("a.kj", {make_shot(1)});
  capture(make_shot(2));
  auto half = bytes_of(layout_.capture_of("shot-2"));
  half.resize(half.size() / 2);
  const auto left = layout_.shots() / ".shot-1.h5.Ab12Cd.part";
  write_bytes(left, half);
  std::ofstream(layout_.shots() / "notes.part") << "not ours";
  const auto report = recover_store(layout_);
  EXPECT_EQ(report.temporary_files, 1U);
  EXPECT_FALSE(std::filesystem::exists(left));
  EXPECT_TRUE(std::filesystem::exists(layout_.shots() / "notes.part"));
  EXPECT_EQ(report.recovered, (std::vector<std::string>{"shot-1"}));
  EXPECT_TRUE(report.problems.empty());
}

TEST_F(Store, RecoveryLeavesAFileThatIsBeingWritten) {
  NewFile living(layout_.shots() / "shot-9.h5");
  EXPECT_EQ(recover_store(layout_).temporary_files, 0U);
  living.write("x");
  living.publish(0444);
  EXPECT_TRUE(std::filesystem::exists(layout_.shots() / "shot-9.h5"));
}

TEST_F(Store, ACaptureThatDiffersFromTheJournalIsReportedAndKept) {
  Shot other = make_shot(1);
  other.channels[1].codes[7] ^= 1;
  capture(other);
  journal("a.kj", {make_shot(1)});
  const auto before = bytes_of(layout_.capture_of("shot-1"));
  for (const auto& report : {recover_store(layout_), verify_store(layout_)}) {
    ASSERT_EQ(report.problems.size(), 1U);
    EXPECT_NE(report.problems[0].text.find("codes differ"), std::string::npos);
    EXPECT_NE(report.problems[0].file.find("shot-1.h5"), std::string::npos);
  }
  EXPECT_EQ(bytes_of(layout_.capture_of("shot-1")), before);
}

TEST_F(Store, ACaptureWithOtherMetadataIsReported) {
  Shot other = make_shot(1);
  other.meta["specimen"] = "another";
  capture(other);
  journal("a.kj", {make_shot(1)});
  const auto report = verify_store(layout_);
  ASSERT_EQ(report.problems.size(), 1U);
  EXPECT_NE(report.problems[0].text.find("shot differs"), std::string::npos);
}

TEST_F(Store, ADamagedCaptureIsSetAsideAndRestoredFromItsJournal) {
  journal("a.kj", {make_shot(1)});
  const auto restore = [&](const std::string& aside) {
    auto bytes = bytes_of(layout_.capture_of("shot-1"));
    bytes[bytes.size() / 2] ^= std::byte{4};
    std::filesystem::remove(layout_.capture_of("shot-1"));
    write_bytes(layout_.capture_of("shot-1"), bytes);
    const auto before = verify_store(layout_);
    ASSERT_EQ(before.problems.size(), 1U);
    EXPECT_NE(before.problems[0].file.find("shot-1.h5"), std::string::npos);
    EXPECT_NE(before.problems[0].text.find("a.kj"), std::string::npos);
    EXPECT_EQ(before.problems[0].kind, StoreReport::Problem::Kind::in_journal);
    const auto report = recover_store(layout_);
    EXPECT_TRUE(report.problems.empty());
    EXPECT_EQ(report.recovered, std::vector<std::string>{"shot-1"});
    EXPECT_EQ(report.set_aside, std::vector<std::string>{(layout_.shots() / aside).string()});
    EXPECT_EQ(bytes_of(layout_.shots() / aside), bytes);
    expect_same(read_capture(layout_.capture_of("shot-1")), make_shot(1));
    EXPECT_TRUE(verify_store(layout_).problems.empty());
  };
  capture(make_shot(1));
  restore("shot-1.h5.damaged");
  restore("shot-1.h5.damaged-2");
}

TEST_F(Store, ADamagedCaptureWithoutAJournalIsReportedAndKept) {
  capture(make_shot(1));
  auto bytes = bytes_of(layout_.capture_of("shot-1"));
  bytes[bytes.size() / 2] ^= std::byte{4};
  write_bytes(layout_.capture_of("shot-1"), bytes);
  EXPECT_TRUE(recover_store(layout_).set_aside.empty());
  const auto report = verify_store(layout_);
  ASSERT_EQ(report.problems.size(), 1U);
  EXPECT_EQ(report.problems[0].kind, StoreReport::Problem::Kind::damaged);
  EXPECT_EQ(bytes_of(layout_.capture_of("shot-1")), bytes);
}

TEST_F(Store, AShotOfTheCatalogueThatIsNowhereIsMissing) {
  journal("a.kj", {make_shot(1)});
  capture(make_shot(2));
  Catalogue catalogue(layout_.catalogue());
  for (const std::string id : {"shot-1", "shot-2", "shot-3"}) {
    CatalogueEntry entry;
    entry.id = id;
    entry.capture = id + ".h5";
    catalogue.put(entry);
  }
  const auto report = verify_store(layout_);
  EXPECT_TRUE(report.catalogue_read);
  ASSERT_EQ(report.problems.size(), 2U);
  EXPECT_EQ(report.problems[0].kind, StoreReport::Problem::Kind::in_journal);
  EXPECT_NE(report.problems[0].text.find("shot-1"), std::string::npos);
  EXPECT_EQ(report.problems[1].kind, StoreReport::Problem::Kind::missing);
  EXPECT_NE(report.problems[1].file.find("shot-3.h5"), std::string::npos);
}

TEST_F(Store, VerifyingChangesNoCatalogueAndMindsNoBrokenOne) {
  std::ofstream(layout_.catalogue()) << "no database";
  const auto bytes = bytes_of(layout_.catalogue());
  const auto report = verify_store(layout_);
  EXPECT_TRUE(report.problems.empty());
  EXPECT_FALSE(report.catalogue_read);
  EXPECT_EQ(bytes_of(layout_.catalogue()), bytes);
}

TEST_F(Store, FilesWhatIsAskedForOutOfJournalsInUse) {
  Journal open(layout_.journals() / "a.kj");
  for (std::uint32_t i = 1; i <= 3; ++i) {
    open.append_shot(make_shot(i));
  }
  const auto report = file_journaled(layout_, {"shot-1", "shot-3", "shot-9"});
  EXPECT_EQ(report.recovered, (std::vector<std::string>{"shot-1", "shot-3"}));
  EXPECT_TRUE(report.problems.empty());
  EXPECT_FALSE(std::filesystem::exists(layout_.capture_of("shot-2")));
  expect_same(read_capture(layout_.capture_of("shot-3")), make_shot(3));
  EXPECT_EQ(file_journaled(layout_, {"shot-1"}).recovered, std::vector<std::string>{"shot-1"})
      << "a capture that is there already, as of a crash before the catalogue had it";
}

TEST_F(Store, CountsTheShotsOfTheJournalsThatItRemoves) {
  journal("a.kj", {make_shot(1), make_shot(2)});
  journal("b.kj", {make_shot(3)});
  Shot other = make_shot(3);
  other.channels[0].codes[1] ^= 1;
  capture(other);  // so that the second journal has to stay
  const auto report = recover_store(layout_, DoneJournals::prune);
  EXPECT_EQ(report.pruned.size(), 1U);
  EXPECT_EQ(report.pruned_shots, 2U);
}

TEST_F(Store, ADamagedJournalStillGivesItsOtherShots) {
  journal("a.kj", {make_shot(1), make_shot(2), make_shot(3)});
  auto bytes = bytes_of(layout_.journals() / "a.kj");
  bytes[bytes.size() / 2] ^= std::byte{4};
  write_bytes(layout_.journals() / "a.kj", bytes);
  const auto report = recover_store(layout_);
  EXPECT_EQ(report.recovered, (std::vector<std::string>{"shot-1", "shot-3"}));
  ASSERT_EQ(report.problems.size(), 1U);
  EXPECT_NE(report.problems[0].file.find("a.kj"), std::string::npos);
}

TEST_F(Store, ATornJournalIsCountedAndNoProblem) {
  journal("a.kj", {make_shot(1), make_shot(2)});
  auto bytes = bytes_of(layout_.journals() / "a.kj");
  bytes.resize(bytes.size() - 1000);
  write_bytes(layout_.journals() / "a.kj", bytes);
  const auto report = recover_store(layout_);
  EXPECT_EQ(report.recovered, (std::vector<std::string>{"shot-1"}));
  EXPECT_TRUE(report.problems.empty());
  EXPECT_GT(report.bytes_ignored, 500U);
  EXPECT_EQ(verify_store(layout_).bytes_ignored, report.bytes_ignored);
}

TEST_F(Store, TheSameShotTwiceIsOneShot) {
  journal("a.kj", {make_shot(1), make_shot(1)});
  journal("b.kj", {make_shot(1)});
  const auto report = recover_store(layout_);
  EXPECT_EQ(report.recovered.size(), 1U);
  EXPECT_EQ(report.journaled_shots, 1U);
  EXPECT_TRUE(report.problems.empty());
}

TEST_F(Store, TwoShotsOfOneIdAreReported) {
  Shot other = make_shot(2);
  other.id = "shot-1";
  journal("a.kj", {make_shot(1)});
  journal("b.kj", {other});
  for (const auto& report : {recover_store(layout_), verify_store(layout_)}) {
    ASSERT_EQ(report.problems.size(), 1U);
    EXPECT_NE(report.problems[0].file.find("b.kj"), std::string::npos);
    EXPECT_NE(report.problems[0].text.find("shot-1"), std::string::npos);
  }
  expect_same(read_capture(layout_.capture_of("shot-1")), make_shot(1));
}

TEST_F(Store, ACaptureUnderTheNameOfAnotherIsReported) {
  write_capture(make_shot(1), layout_.capture_of("shot-2"));
  const auto report = verify_store(layout_);
  ASSERT_EQ(report.problems.size(), 1U);
  EXPECT_NE(report.problems[0].text.find("holds the shot shot-1"), std::string::npos);
}

TEST_F(Store, StrangersAmongTheFilesAreReported) {
  std::ofstream(layout_.journals() / "text.kj") << "text";
  std::ofstream(layout_.shots() / "text.h5") << "text";
  EXPECT_EQ(verify_store(layout_).problems.size(), 2U);
}

TEST(NoStore, IsRefusedAndNotMade) {
  const ScratchFolder folder;
  expect_refused([&] { (void)verify_store({folder / "gone"}); }, {"gone", "store"});
  EXPECT_FALSE(std::filesystem::exists(folder / "gone"));
  std::ofstream(folder / "file") << "x";
  expect_refused([&] { StoreLayout{folder / "file"}.create(); }, {"file"});
}

}  // namespace
}  // namespace kolsky
