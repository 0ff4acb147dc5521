#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "drivers/files/store/journal.hpp"
#include "drivers/files/store/store.hpp"

namespace kolsky {

/// The journals of one run, for the recorder (shots) and the archivist (what became of them). One
/// takes shots at a time; when it has grown to its limit the archivist begins the next. A failed
/// write is tried once more, in a new file: what a reader finds behind a torn record is not to be
/// trusted.
class SharedJournal {
 public:
  /// @param limit_bytes  length at which a journal is ended
  /// @throws InputError where the store cannot be written
  SharedJournal(const StoreLayout& store, std::uint64_t boot_id, std::uint64_t limit_bytes);

  /// The shot survives the end of the process, not yet that of the machine.
  /// @throws std::runtime_error or InputError if no journal took it
  void write_shot(const Shot& shot);
  /// Returns when this shot, the last one written, is durable.
  /// @throws std::runtime_error if it is not
  void make_durable(const Shot& shot);
  void append_stored(const std::string& shot_id, const std::filesystem::path& capture);

  /// Whether a journal has this shot, and it is not stored yet.
  [[nodiscard]] bool holds(const std::string& shot_id) const;

  /// Ends the journal if it has grown to its limit; what is appended from now on goes to a new one.
  /// For the archivist: making a file takes longer than a shot should wait.
  /// @throws InputError where a new one cannot be made; the old one goes on
  void turn_over();
  /// Journals that were ended and whose every shot is stored, closed; each is named once.
  [[nodiscard]] std::vector<std::filesystem::path> take_done();

 private:
  [[nodiscard]] std::shared_ptr<Journal> current();
  [[nodiscard]] std::filesystem::path next_path();
  void give_up(const std::shared_ptr<Journal>& journal);
  /// @return the journal it was written to
  template <typename Append>
  std::shared_ptr<Journal> append(const Append& write);

  std::filesystem::path folder_;
  std::uint64_t boot_id_;
  std::uint64_t limit_bytes_;
  mutable std::mutex
      mutex_;  ///< guards what follows, not the writing: that locks itself, for less long
  int files_ = 0;
  std::shared_ptr<Journal> journal_;
  std::map<std::string, std::shared_ptr<Journal>> not_stored_;  ///< by shot
  std::shared_ptr<Journal> written_;  ///< has the last shot; the recorder's alone
  /// Held by nobody else, they are done: no shot of theirs is in `not_stored_` and none is on its
  /// way there.
  std::vector<std::shared_ptr<Journal>> ended_;
};

}  // namespace kolsky
