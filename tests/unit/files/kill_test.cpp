#include <poll.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <random>
#include <set>
#include <thread>

#include "drivers/files/captures/capture.hpp"
#include "drivers/files/store/journal.hpp"
#include "drivers/files/store/store.hpp"
#include "tests/scratch_folder.hpp"
#include "tests/unit/files/stored_shots.hpp"

namespace kolsky {
namespace {

using testing::make_shot;
using testing::ScratchFolder;

constexpr int kRounds = 30;
constexpr int kTornRounds = 15;
const testing::ShotShape kShape{2, 4000, 16};

/// What the daemon does with shots, until it is killed. Says which are journaled.
[[noreturn]] void record_shots(const StoreLayout& store, int round, int acknowledge) {
  Journal journal(store.journals() / (std::to_string(round) + ".kj"));
  for (std::uint32_t i = 0;; ++i) {
    const std::uint32_t seed = static_cast<std::uint32_t>(round) * 1'000'000 + i;
    const Shot shot = make_shot(seed, kShape);
    journal.append_shot(shot);
    if (::write(acknowledge, &seed, sizeof seed) != sizeof seed) {
      ::_exit(1);
    }
    write_capture(shot, store.capture_of(shot.id));
    journal.append_stored(shot.id, store.capture_of(shot.id));
  }
}

std::vector<std::uint32_t> acknowledged(int pipe) {
  std::vector<std::uint32_t> seeds;
  std::uint32_t seed = 0;
  while (::read(pipe, &seed, sizeof seed) == sizeof seed) {
    seeds.push_back(seed);
  }
  return seeds;
}

/// One life of the daemon, cut at a random moment. @return the shots it said were journaled
template <typename Record>
std::vector<std::uint32_t> live_and_die(const StoreLayout& store, int round, const Record& record,
                                        std::mt19937& random) {
  int ends[2] = {};
  EXPECT_EQ(::pipe(ends), 0);
  const pid_t child = ::fork();
  if (child == 0) {
    ::close(ends[0]);
    record(store, round, ends[1]);
  }
  ::close(ends[1]);
  // Every third one may die before its first shot, the others after it.
  pollfd first{ends[0], POLLIN, 0};
  if (round % 3 != 0) {
    EXPECT_EQ(::poll(&first, 1, 20'000), 1);
  }
  std::this_thread::sleep_for(std::chrono::microseconds(random() % 40'000));
  ::kill(child, SIGKILL);
  int status = 0;
  EXPECT_EQ(::waitpid(child, &status, 0), child);
  EXPECT_TRUE(WIFSIGNALED(status)) << "it ended by itself";
  auto seeds = acknowledged(ends[0]);
  ::close(ends[0]);
  return seeds;
}

TEST(Kill, EveryJournaledShotIsRecoveredWhateverTheMoment) {
  const ScratchFolder folder;
  const StoreLayout store{folder / "store"};
  store.create();
  std::mt19937 random(20240229);
  std::vector<std::uint32_t> journaled;
  std::size_t recovered = 0;
  std::size_t temporary = 0;
  for (int round = 0; round < kRounds; ++round) {
    const auto seeds = live_and_die(store, round, record_shots, random);
    journaled.insert(journaled.end(), seeds.begin(), seeds.end());
    const auto report = recover_store(store);
    for (const auto& problem : report.problems) {
      ADD_FAILURE() << problem.file << ": " << problem.text;
    }
    recovered += report.recovered.size();
    temporary += report.temporary_files;
    for (const std::uint32_t seed : seeds) {
      const Shot expected = make_shot(seed, kShape);
      EXPECT_EQ(read_capture(store.capture_of(expected.id)).channels, expected.channels);
    }
  }
  const auto report = verify_store(store);
  EXPECT_TRUE(report.problems.empty());
  // A shot may be durable before it could say so; none may be lost, none made up.
  EXPECT_GE(report.captures, journaled.size());
  EXPECT_LE(report.captures, journaled.size() + kRounds);
  EXPECT_EQ(report.captures, report.journaled_shots);
  EXPECT_GT(recovered, 0U) << "no kill came between journal and capture: the test shows nothing";
  std::cout << journaled.size() << " shots in " << kRounds << " lives, " << recovered
            << " captures recovered, " << temporary << " half-written ones removed, "
            << report.bytes_ignored << " torn bytes\n";
}

/// Large records and nothing else, so that most kills come while one is written.
[[noreturn]] void journal_large_shots(const StoreLayout& store, int round, int acknowledge) {
  Journal journal(store.journals() / (std::to_string(round) + ".kj"));
  Shot shot = make_shot(0, {1, 1'000'000, 16});
  for (std::uint32_t i = 0;; ++i) {
    shot.id = "large-" + std::to_string(round) + "-" + std::to_string(i);
    shot.channels[0].codes[0] = static_cast<std::int32_t>(i);
    journal.append_shot(shot);
    if (::write(acknowledge, &i, sizeof i) != sizeof i) {
      ::_exit(1);
    }
  }
}

TEST(Kill, ATornRecordCostsNoOther) {
  // In memory, where nothing waits for a disk, most of the time goes into writing.
  const std::filesystem::path memory = "/dev/shm";
  const ScratchFolder folder(
      std::filesystem::is_directory(memory) ? memory : std::filesystem::temp_directory_path());
  const StoreLayout store{folder / "store"};
  store.create();
  std::mt19937 random(1);
  const auto codes = make_shot(0, {1, 1'000'000, 16}).channels[0].codes;
  std::uint64_t torn_bytes = 0;
  for (int round = 0; round < kTornRounds; ++round) {
    const auto acknowledged_shots = live_and_die(store, round, journal_large_shots, random);
    const auto path = store.journals() / (std::to_string(round) + ".kj");
    if (acknowledged_shots.empty() && !std::filesystem::exists(path)) {
      continue;
    }
    const auto contents = read_journal(path);
    EXPECT_TRUE(contents.problems.empty());
    EXPECT_GE(contents.shots.size(), acknowledged_shots.size());
    EXPECT_LE(contents.shots.size(), acknowledged_shots.size() + 1);
    torn_bytes += contents.bytes_ignored;
    for (std::size_t i = 0; i < contents.shots.size(); ++i) {
      const auto& read = contents.shots[i].channels[0].codes;
      EXPECT_EQ(read[0], static_cast<std::int32_t>(i));
      EXPECT_TRUE(std::equal(read.begin() + 1, read.end(), codes.begin() + 1, codes.end()));
    }
    std::filesystem::remove(path);
  }
  std::cout << torn_bytes << " torn bytes in " << kTornRounds << " lives\n";
}

}  // namespace
}  // namespace kolsky
