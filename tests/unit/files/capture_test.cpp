#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <fstream>

#include "drivers/files/captures/capture.hpp"
#include "tests/scratch_folder.hpp"
#include "tests/unit/files/full_disk.hpp"
#include "tests/unit/files/stored_shots.hpp"

namespace kolsky {
namespace {

using testing::bytes_of;
using testing::expect_refused;
using testing::expect_same;
using testing::make_shot;
using testing::ScratchFolder;

TEST(Capture, GivesTheShotBack) {
  const ScratchFolder folder;
  for (const int bits : {12, 16, 18, 24, 32}) {
    const auto path = folder / (std::to_string(bits) + ".h5");
    const Shot shot = make_shot(1, {4, 4096, bits});
    write_capture(shot, path);
    const Shot back = read_capture(path);
    expect_same(back, shot);
    ASSERT_EQ(back.bench.gauges.size(), 4U);
    EXPECT_EQ(back.bench.gauges[2].position_m.value, shot.bench.gauges[2].position_m.value);
  }
}

TEST(Capture, KeepsHowItsShotIsToBeReduced) {
  const ScratchFolder folder;
  Shot shot = testing::asked_shot();
  write_capture(shot, folder / "all.h5");
  expect_same(read_capture(folder / "all.h5"), shot);
  shot.reduction = {};
  shot.reduction.duration_s = 1e-3;
  write_capture(shot, folder / "one.h5");
  expect_same(read_capture(folder / "one.h5"), shot);
}

TEST(Capture, GivesBackWhatIsOptionalAndEmpty) {
  const ScratchFolder folder;
  Shot shot = make_shot(2, {1, 1});
  shot.bar_model.reset();
  shot.trigger.reset();
  shot.gaps.clear();
  shot.meta.clear();
  shot.software_version.clear();
  write_capture(shot, folder / "a.h5");
  expect_same(read_capture(folder / "a.h5"), shot);
}

// Gauges and facts may have names that HDF5 cannot link an object by, or uses itself.
TEST(Capture, TakesAnyName) {
  const ScratchFolder folder;
  Shot shot = make_shot(3, {3, 10});
  const std::vector<std::string> names{"time", "time_", "in-1"};
  for (std::size_t i = 0; i < names.size(); ++i) {
    const std::string old = "\"g" + std::to_string(i + 1) + "\"";
    shot.bench_toml.replace(shot.bench_toml.find(old), old.size(), "\"" + names[i] + "\"");
    shot.channels[i].gauge = names[i];
  }
  shot.meta = {{"", "empty"}, {".", "dot"}, {"a/b", "1"}, {"a_b", "2"}, {"µ", "3"}};
  write_capture(shot, folder / "a.h5");
  expect_same(read_capture(folder / "a.h5"), shot);
}

TEST(Capture, TheSameShotGivesTheSameBytes) {
  const ScratchFolder folder;
  write_capture(make_shot(4), folder / "a.h5");
  write_capture(make_shot(4), folder / "b.h5");
  EXPECT_EQ(bytes_of(folder / "a.h5"), bytes_of(folder / "b.h5"));
}

TEST(Capture, IsReadOnlyAndNeverOverwritten) {
  const ScratchFolder folder;
  write_capture(make_shot(5), folder / "a.h5");
  struct stat status {};
  ASSERT_EQ(::stat((folder / "a.h5").c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 0777U, 0444U);
  const auto before = bytes_of(folder / "a.h5");
  expect_refused([&] { write_capture(make_shot(6), folder / "a.h5"); }, {"a.h5", "exists"});
  EXPECT_EQ(bytes_of(folder / "a.h5"), before);
}

TEST(Capture, LeavesNoOtherFile) {
  const ScratchFolder folder;
  write_capture(make_shot(7), folder / "a.h5");
  expect_refused([&] { write_capture(make_shot(7), folder / "a.h5"); });
  Shot bad = make_shot(8);
  bad.channels.clear();
  expect_refused([&] { write_capture(bad, folder / "b.h5"); }, {"b.h5", "channels"});
  const std::filesystem::directory_iterator items(folder.path());
  EXPECT_EQ(std::distance(begin(items), end(items)), 1);
}

TEST(Capture, RefusesAFolderThatIsNotThere) {
  const ScratchFolder folder;
  expect_refused([&] { write_capture(make_shot(9), folder / "no/a.h5"); }, {"no/a.h5"});
}

// A file-size limit stands in for a full disk.
TEST(Capture, AFullDiskIsRefusedAndLeavesNothing) {
  const ScratchFolder folder;
  const pid_t child = ::fork();
  if (child == 0) {
    ::signal(SIGXFSZ, SIG_IGN);
    const rlimit limit{20'000, RLIM_INFINITY};
    ::setrlimit(RLIMIT_FSIZE, &limit);
    try {
      write_capture(make_shot(10, {2, 4000}), folder / "a.h5");
    } catch (const InputError&) {
      const bool left = !std::filesystem::is_empty(folder.path());
      const rlimit space{RLIM_INFINITY, RLIM_INFINITY};
      ::setrlimit(RLIMIT_FSIZE, &space);
      write_capture(make_shot(10, {2, 4000}), folder / "a.h5");
      ::_exit(left ? 3 : 2);
    }
    ::_exit(0);
  }
  int status = 0;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  ASSERT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 2);
  // With space again it works again.
  expect_same(read_capture(folder / "a.h5"), make_shot(10, {2, 4000}));
}

TEST(CapturesIn, GivesAFileOrAFolderByName) {
  const ScratchFolder folder;
  write_capture(make_shot(11), folder / "b.h5");
  write_capture(make_shot(12), folder / "a.h5");
  std::ofstream(folder / ".c.h5.x.part") << "x";
  std::ofstream(folder / ".d.h5") << "x";
  std::ofstream(folder / "notes.txt") << "x";
  const auto captures = captures_in(folder.path());
  EXPECT_EQ(captures, (std::vector<std::filesystem::path>{folder / "a.h5", folder / "b.h5"}));
  EXPECT_EQ(captures_in(folder / "b.h5").size(), 1U);
}

TEST(CapturesIn, RefusesWhereThereIsNone) {
  const ScratchFolder folder;
  expect_refused([&] { (void)captures_in(folder.path()); }, {"no captures"});
  expect_refused([&] { (void)captures_in(folder / "gone"); }, {"does not exist"});
}

TEST(Capture, AFullDiskIsRefusedAndHoldsNothingBack) {
  const ScratchFolder folder;
  const Shot shot = make_shot(1);
  write_capture(shot, folder / "whole.h5");
  const auto bytes = std::filesystem::file_size(folder / "whole.h5");
  const auto open_files = testing::entries_of("/proc/self/fd");
  {
    const testing::FullDisk disk(bytes - 1);
    for (int i = 0; i < 3; ++i) {
      expect_refused([&] { write_capture(shot, folder / "x.h5"); }, {"x.h5", "space on the disk"});
    }
    EXPECT_EQ(testing::entries_of("/proc/self/fd"), open_files);
    EXPECT_EQ(testing::entries_of(folder.path()), 1);
  }
  write_capture(shot, folder / "x.h5");
  expect_same(read_capture(folder / "x.h5"), shot);
}

}  // namespace
}  // namespace kolsky
