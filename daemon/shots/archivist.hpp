#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "daemon/shots/shared_journal.hpp"
#include "daemon/thread.hpp"
#include "drivers/files/store/catalogue.hpp"
#include "drivers/files/store/store.hpp"
#include "processing/reduction/reducer.hpp"

namespace kolsky {

/// A stored shot and what it reduces to.
struct StoredShot {
  Shot shot;
  Reduction reduction;
  std::string capture;  ///< its file
};

/// The one thread of the daemon that writes captures and the catalogue and reads them back. Shots
/// come to it journaled: whatever happens here, or to it, nothing is lost.
class Archivist {
 public:
  /// Told what could not be stored, from the archivist's thread.
  using FaultSink = std::function<void(const std::string& text)>;

  /// How long a shot that could not be filed waits for the next attempt, if no other is filed.
  static constexpr std::chrono::milliseconds kRetry{10'000};

  Archivist(StoreLayout store, SharedJournal& journal, FaultSink fault,
            std::chrono::milliseconds retry = kRetry);
  ~Archivist();
  Archivist(const Archivist&) = delete;
  Archivist& operator=(const Archivist&) = delete;

  /// Begins; captures that the catalogue does not know are judged and entered before anything that
  /// is asked is answered, though after shots that come meanwhile.
  void start();
  /// Stores all that was handed over, then ends. Captures that the catalogue does not know yet are
  /// left to the next start.
  void stop();

  /// One shot is about to be published and will be handed over: what is asked from now on is
  /// answered after that, so that whoever has seen a result finds the shot in the list. Cheap.
  void expect_shot() noexcept { expected_.fetch_add(1); }
  /// Hands over the expected, journaled shot. Waits while `kMostWaiting` others wait.
  void store(std::shared_ptr<const Shot> shot, CatalogueEntry entry);

  /// Reads a capture back and reduces it as is filed with it: what `kolsky reduce` does with that
  /// file.
  /// @throws InputError where there is no such shot or its capture is damaged
  [[nodiscard]] StoredShot get(const std::string& id);
  /// Newest first. @param most 0: all
  [[nodiscard]] std::vector<CatalogueEntry> newest(std::size_t most);

  [[nodiscard]] std::uint64_t stored() const noexcept { return stored_.load(); }
  /// Shots that could not be filed when they came; they are tried again.
  [[nodiscard]] std::uint64_t failed() const noexcept { return failed_.load(); }
  /// Nothing waits and nothing is in hand.
  [[nodiscard]] bool idle() const;
  /// Jobs done: what a watchdog looks at while not idle.
  [[nodiscard]] std::uint64_t progress() const noexcept { return progress_.load(); }

  static constexpr std::size_t kMostWaiting = 64;

 private:
  using Job = std::function<void()>;
  /// A shot whose capture could not be written.
  struct Unfiled {
    CatalogueEntry entry;
    std::shared_ptr<const Shot> shot;  ///< where no journal has it either
    std::string reason;
  };

  void run();
  /// Until there is one, what is left over to be tried again among them, or the end.
  void wait_for_job(std::unique_lock<std::mutex>& lock);
  /// The next one: shots go first. Empty at the end. @pre the mutex is held
  Job take_job();
  void do_job(const Job& job);
  [[nodiscard]] bool ends() const;
  void submit(Job job);
  void await_expected();
  template <typename Ask>
  auto ask(Ask question) -> decltype(question());
  void store_now(const std::shared_ptr<const Shot>& shot, CatalogueEntry entry);
  /// Keeps what could not be filed for another attempt.
  void keep(const std::shared_ptr<const Shot>& shot, CatalogueEntry entry, std::string reason);
  /// What could not be done before.
  void try_again();
  void file_unfiled();
  void file_from_memory();
  void file_from_journals();
  /// The capture of this shot is there.
  void enter_stored(const std::string& shot_id, CatalogueEntry entry);
  /// Ends a journal that is long enough, and removes those that have done their work.
  void tend_journals();
  void prune(const std::filesystem::path& journal);
  /// Has every capture entered that the catalogue does not know, each as a job of its own.
  void complete_catalogue();
  /// A damaged one is listed as such.
  void enter(const std::filesystem::path& capture);
  void note_missing(CatalogueEntry entry);
  void note_incomplete(const std::string& why);
  Catalogue& catalogue();

  StoreLayout store_;
  SharedJournal& journal_;
  FaultSink fault_;
  std::unique_ptr<Catalogue> catalogue_;
  Reducer reducer_;
  std::chrono::milliseconds retry_;
  std::chrono::steady_clock::time_point tried_;  ///< what is left over, if anything is
  std::map<std::string, Unfiled> unfiled_;       ///< by shot; the archivist's thread alone
  std::size_t kept_codes_ = 0;                   ///< in the shots of `unfiled_`
  bool catalogue_complete_ = false;              ///< but for entries under way
  std::string incomplete_because_;

  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Job> shots_to_store_;
  std::deque<Job> jobs_;  ///< all others
  bool busy_ = false;
  std::uint64_t handed_over_ = 0;
  bool stop_ = false;
  std::atomic<std::uint64_t> expected_{0};
  std::atomic<std::uint64_t> stored_{0};
  std::atomic<std::uint64_t> failed_{0};
  std::atomic<std::uint64_t> progress_{0};
  Thread thread_;
};

}  // namespace kolsky
