#include <fcntl.h>
#include <sys/ptrace.h>
#include <sys/syscall.h>
#include <sys/user.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <optional>
#include <set>

#include "drivers/files/captures/capture.hpp"
#include "drivers/files/store/journal.hpp"
#include "drivers/files/store/store.hpp"
#include "tests/scratch_folder.hpp"
#include "tests/unit/files/stored_shots.hpp"

namespace kolsky {
namespace {

using testing::make_shot;
using testing::ScratchFolder;

const testing::ShotShape kShape{2, 400, 16};

/// Three lives of a daemon: one whose captures are all there, one that was killed before the last
/// of its captures, one that never had a shot.
class Pruning : public ::testing::Test {
 protected:
  Pruning() { make(store_); }

  static void make(const StoreLayout& store) {
    store.create();
    journal(store, "1.kj", {1, 2});
    journal(store, "2.kj", {3, 4});
    journal(store, "3.kj", {});
    for (const std::uint32_t seed : {1U, 2U, 3U}) {
      const Shot shot = make_shot(seed, kShape);
      write_capture(shot, store.capture_of(shot.id));
    }
  }

  static void journal(const StoreLayout& store, const std::string& name,
                      const std::vector<std::uint32_t>& seeds) {
    Journal file(store.journals() / name);
    for (const std::uint32_t seed : seeds) {
      file.append_shot(make_shot(seed, kShape));
    }
  }

  static std::set<std::string> journals(const StoreLayout& store) {
    std::set<std::string> names;
    for (const auto& file : std::filesystem::directory_iterator(store.journals())) {
      names.insert(file.path().filename().string());
    }
    return names;
  }

  static void expect_all_captured(const StoreLayout& store) {
    for (const std::uint32_t seed : {1U, 2U, 3U, 4U}) {
      const Shot expected = make_shot(seed, kShape);
      testing::expect_same(read_capture(store.capture_of(expected.id)), expected);
    }
    EXPECT_TRUE(verify_store(store).problems.empty());
  }

  ScratchFolder folder_;
  StoreLayout store_{folder_ / "store"};
};

TEST_F(Pruning, RemovesWhatIsReadBackFromCaptures) {
  const StoreReport report = recover_store(store_, DoneJournals::prune);
  EXPECT_EQ(report.recovered, std::vector<std::string>{make_shot(4, kShape).id});
  EXPECT_EQ(report.pruned.size(), 3U);
  EXPECT_TRUE(report.problems.empty());
  EXPECT_TRUE(journals(store_).empty());
  expect_all_captured(store_);
}

TEST_F(Pruning, IsLeftOutUnlessAskedFor) {
  EXPECT_TRUE(recover_store(store_).pruned.empty());
  EXPECT_EQ(journals(store_).size(), 3U);
}

TEST_F(Pruning, KeepsAJournalWhoseShotIsInADifferentCapture) {
  const Shot shot = make_shot(2, kShape);
  std::filesystem::remove(store_.capture_of(shot.id));
  Shot other = shot;
  other.channels[0].codes[7] += 1;
  write_capture(other, store_.capture_of(shot.id));
  const StoreReport report = recover_store(store_, DoneJournals::prune);
  EXPECT_EQ(report.problems.size(), 1U);
  EXPECT_EQ(journals(store_), std::set<std::string>{"1.kj"});
}

TEST_F(Pruning, KeepsAJournalWhoseCaptureIsDamagedUntilItIsRestored) {
  const auto capture = store_.capture_of(make_shot(1, kShape).id);
  auto bytes = testing::bytes_of(capture);
  bytes[bytes.size() / 2] ^= std::byte{1};
  std::filesystem::permissions(capture, std::filesystem::perms::owner_all);
  testing::write_bytes(capture, bytes);
  EXPECT_FALSE(prune_journal(store_, store_.journals() / "1.kj").problems.empty());
  EXPECT_TRUE(journals(store_).contains("1.kj"));
  EXPECT_TRUE(recover_store(store_, DoneJournals::prune).problems.empty());
  EXPECT_TRUE(journals(store_).empty());
  expect_all_captured(store_);
}

TEST_F(Pruning, KeepsADamagedJournal) {
  const auto path = store_.journals() / "1.kj";
  auto bytes = testing::bytes_of(path);
  bytes[bytes.size() / 2] ^= std::byte{1};
  testing::write_bytes(path, bytes);
  EXPECT_FALSE(recover_store(store_, DoneJournals::prune).problems.empty());
  EXPECT_EQ(journals(store_), std::set<std::string>{"1.kj"});
}

TEST_F(Pruning, TakesAShotThatTwoJournalsHold) {
  journal(store_, "4.kj", {1});
  EXPECT_EQ(recover_store(store_, DoneJournals::prune).pruned.size(), 4U);
  expect_all_captured(store_);
}

TEST_F(Pruning, KeepsASecondDifferentShotOfTheSameName) {
  Shot other = make_shot(1, kShape);
  other.channels[0].codes[7] += 1;
  Journal(store_.journals() / "4.kj").append_shot(other);
  EXPECT_EQ(recover_store(store_, DoneJournals::prune).problems.size(), 1U);
  EXPECT_EQ(journals(store_), std::set<std::string>{"4.kj"});
}

TEST_F(Pruning, PassesOverATornEnd) {
  const auto path = store_.journals() / "1.kj";
  auto bytes = testing::bytes_of(path);
  bytes.resize(bytes.size() - 100);  // the second shot's record
  testing::write_bytes(path, bytes);
  EXPECT_EQ(recover_store(store_, DoneJournals::prune).pruned.size(), 3U);
}

TEST_F(Pruning, TakesOneJournalOnRequest) {
  const StoreReport report = prune_journal(store_, store_.journals() / "1.kj");
  EXPECT_TRUE(report.problems.empty());
  EXPECT_EQ(report.journaled_shots, 2U);
  EXPECT_EQ(journals(store_), (std::set<std::string>{"2.kj", "3.kj"}));
}

TEST_F(Pruning, OnRequestKeepsAJournalWhoseShotHasNoCapture) {
  const StoreReport report = prune_journal(store_, store_.journals() / "2.kj");
  ASSERT_EQ(report.problems.size(), 1U);
  EXPECT_EQ(report.problems[0].file, store_.capture_of(make_shot(4, kShape).id));
  EXPECT_EQ(journals(store_).size(), 3U);
}

#if defined(__x86_64__) && !defined(KOLSKY_SANITIZED)

/// A system call that changes what is on the disk, or makes it durable.
struct Change {
  enum class Kind { sync, rename, unlink, other } kind = Kind::other;
  std::string path;
};

std::optional<Change> change_of(pid_t child, const user_regs_struct& call) {
  const auto text_at = [child](unsigned long long address) {
    std::string text;
    for (;; ++address) {
      const long word = ::ptrace(PTRACE_PEEKDATA, child, address, nullptr);
      const char c = static_cast<char>(word & 0xFF);
      if (c == '\0' || text.size() > 4096) {
        return text;
      }
      text.push_back(c);
    }
  };
  const auto name_of = [child](unsigned long long file) {
    std::error_code ignored;
    const std::string link = "/proc/" + std::to_string(child) + "/fd/" + std::to_string(file);
    return std::filesystem::read_symlink(link, ignored).string();
  };
  switch (call.orig_rax) {
    case SYS_fsync:
    case SYS_fdatasync:
      return Change{Change::Kind::sync, name_of(call.rdi)};
    case SYS_rename:
    case SYS_renameat:
    case SYS_renameat2:
    case SYS_link:
    case SYS_linkat:
      return Change{Change::Kind::rename, {}};
    case SYS_unlink:
      return Change{Change::Kind::unlink, text_at(call.rdi)};
    case SYS_unlinkat:
      return Change{Change::Kind::unlink, text_at(call.rsi)};
    case SYS_openat:
      return (call.rdx & O_CREAT) != 0 ? std::optional(Change{}) : std::nullopt;
    case SYS_write:
    case SYS_pwrite64:
    case SYS_ftruncate:
    case SYS_chmod:
    case SYS_fchmod:
      return Change{};
    default:
      return std::nullopt;
  }
}

/// Runs a program in a process of its own that is killed before its change number `last`.
/// @return the changes before that; all of them where it came to its end
template <typename Program>
std::optional<std::vector<Change>> run_until(std::size_t last, const Program& program) {
  const pid_t child = ::fork();
  if (child == 0) {
    if (::ptrace(PTRACE_TRACEME, 0, nullptr, nullptr) != 0) {
      ::_exit(77);
    }
    ::raise(SIGSTOP);
    ::_exit(program() ? 0 : 1);
  }
  std::vector<Change> changes;
  int status = 0;
  ::waitpid(child, &status, 0);
  if (WIFEXITED(status)) {
    return std::nullopt;  // tracing is not permitted here
  }
  bool entering = true;
  while (::ptrace(PTRACE_SYSCALL, child, nullptr, nullptr) == 0 &&
         ::waitpid(child, &status, 0) == child && !WIFEXITED(status)) {
    user_regs_struct call{};
    ::ptrace(PTRACE_GETREGS, child, nullptr, &call);
    const std::optional<Change> change = entering ? change_of(child, call) : std::nullopt;
    entering = !entering;
    if (change && changes.size() == last) {
      ::kill(child, SIGKILL);
      ::waitpid(child, &status, 0);
      return changes;
    }
    if (change) {
      changes.push_back(*change);
    }
  }
  EXPECT_EQ(WEXITSTATUS(status), 0);
  return changes;
}

std::optional<std::vector<Change>> recover_until(const StoreLayout& store, std::size_t last) {
  return run_until(last,
                   [&] { return recover_store(store, DoneJournals::prune).problems.empty(); });
}

/// A run of the daemon whose journals take one shot each. Says which shots are journaled.
bool live(const StoreLayout& store, int acknowledge) {
  std::filesystem::path ended;
  for (std::uint32_t seed = 11; seed < 14; ++seed) {
    const auto path = store.journals() / (std::to_string(seed) + ".kj");
    Journal journal(path);
    const Shot shot = make_shot(seed, kShape);
    journal.append_shot(shot);
    if (::write(acknowledge, &seed, sizeof seed) != sizeof seed) {
      return false;
    }
    write_capture(shot, store.capture_of(shot.id));
    journal.append_stored(shot.id, store.capture_of(shot.id));
    if (!ended.empty() && prune_journal(store, ended).pruned.empty()) {
      return false;
    }
    ended = path;
  }
  return true;
}

TEST_F(Pruning, LosesNothingWhereverARunIsKilledThatTurnsItsJournalsOver) {
  std::size_t kills = 0;
  std::size_t pruned = 0;
  for (bool ended = false; !ended; ++kills) {
    const StoreLayout store{folder_ / ("run-" + std::to_string(kills))};
    store.create();
    int ends[2] = {};
    ASSERT_EQ(::pipe(ends), 0);
    const auto changes = run_until(kills, [&] { return live(store, ends[1]); });
    ::close(ends[1]);
    if (!changes) {
      ::close(ends[0]);
      GTEST_SKIP() << "processes cannot be traced here";
    }
    ended = changes->size() < kills;
    pruned += std::count_if(changes->begin(), changes->end(), [](const Change& change) {
      return change.kind == Change::Kind::unlink && change.path.ends_with(".kj");
    });
    EXPECT_TRUE(recover_store(store, DoneJournals::prune).problems.empty());
    EXPECT_TRUE(journals(store).empty());
    std::uint32_t seed = 0;
    while (::read(ends[0], &seed, sizeof seed) == sizeof seed) {
      const Shot expected = make_shot(seed, kShape);
      testing::expect_same(read_capture(store.capture_of(expected.id)), expected);
    }
    ::close(ends[0]);
    std::filesystem::remove_all(store.root);
  }
  EXPECT_GT(pruned, 10U) << "few kills came after a journal was removed";
  std::cout << kills << " kill points\n";
}

TEST_F(Pruning, LosesNothingWhereverItIsKilled) {
  std::size_t kills = 0;
  for (;; ++kills) {
    const StoreLayout store{folder_ / ("killed-" + std::to_string(kills))};
    std::filesystem::copy(store_.root, store.root, std::filesystem::copy_options::recursive);
    const auto changes = recover_until(store, kills);
    if (!changes) {
      GTEST_SKIP() << "processes cannot be traced here";
    }
    const bool ended = changes->size() < kills;
    // What is only in journals now is still there, what is in neither is lost.
    (void)recover_store(store);
    expect_all_captured(store);
    (void)recover_store(store, DoneJournals::prune);
    EXPECT_TRUE(journals(store).empty());
    std::filesystem::remove_all(store.root);
    if (ended) {
      break;
    }
  }
  EXPECT_GT(kills, 10U);
  std::cout << kills << " kill points\n";
}

TEST_F(Pruning, MakesTheCapturesNamesDurableBeforeAJournalGoes) {
  const auto changes = recover_until(store_, SIZE_MAX);
  if (!changes) {
    GTEST_SKIP() << "processes cannot be traced here";
  }
  bool durable = false;
  std::size_t removed = 0;
  for (const Change& change : *changes) {
    durable = durable || (change.kind == Change::Kind::sync && change.path == store_.shots());
    durable = durable && change.kind != Change::Kind::rename;
    if (change.kind == Change::Kind::unlink && change.path.ends_with(".kj")) {
      EXPECT_TRUE(durable) << change.path;
      ++removed;
    }
  }
  EXPECT_EQ(removed, 3U);
  EXPECT_EQ(changes->back().path, store_.journals()) << "or removed journals might come back";
}

#endif

}  // namespace
}  // namespace kolsky
