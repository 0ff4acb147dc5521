#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <mutex>
#include <string>

#include "drivers/files/journal.hpp"
#include "drivers/files/store.hpp"

namespace kolsky {

/// The journal of one run, for the recorder (shots) and the archivist (what became of them). A
/// failed write is tried once more, in a new file: what a reader finds behind a torn record is not
/// to be trusted.
class SharedJournal {
 public:
  /// @throws InputError where the store cannot be written
  SharedJournal(const StoreLayout& store, std::uint64_t boot_id);

  /// Returns when the shot is durable. @throws std::runtime_error or InputError if it is not
  void append_shot(const Shot& shot);
  void append_stored(const std::string& shot_id, const std::filesystem::path& capture);

 private:
  [[nodiscard]] std::shared_ptr<Journal> current();
  void give_up(const std::shared_ptr<Journal>& journal);
  template <typename Append>
  void append(const Append& write);

  std::filesystem::path folder_;
  std::uint64_t boot_id_;
  std::mutex
      mutex_;  ///< guards which journal it is, not the writing: that locks itself, for less long
  int files_ = 0;
  std::shared_ptr<Journal> journal_;
};

}  // namespace kolsky
