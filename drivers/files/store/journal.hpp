#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <mutex>
#include <string>
#include <vector>

#include "processing/base/shot.hpp"

namespace kolsky {

/// The truth about a shot until its capture is durable: an append-only file of checksummed records,
/// `store/journal/<boot>.kj`. A record is whole or it is not there; whatever a crash leaves at the
/// end is ignored. See docs/capture-format.md. Two threads may append: one the shots, one what was
/// stored.
class Journal {
 public:
  /// Makes a new file, durable under its name, with room ahead.
  /// @throws InputError if it exists or the folder cannot be written
  explicit Journal(const std::filesystem::path& path);
  /// Gives the room left over back.
  ~Journal();
  Journal(const Journal&) = delete;
  Journal& operator=(const Journal&) = delete;

  /// Appends the shot: the end of the process cannot take it any more, the end of the machine can
  /// until `make_durable` has returned.
  /// @throws InputError if it could never become a capture (see check_storable), nothing is written
  /// then
  /// @throws std::runtime_error on a write error
  void write_shot(const Shot& shot);

  /// Returns when all that was written is durable: one fdatasync.
  /// @throws std::runtime_error where it fails; this journal takes no more then, since what the
  /// disk holds is unknown: go on with a new one
  void make_durable();

  /// Both of these.
  void append_shot(const Shot& shot);

  /// Says that the capture of this shot is durable at `capture`. Lost in a crash it harms nothing,
  /// so it does not wait for the disk; it tops up the room ahead while nobody waits.
  /// @throws std::runtime_error on a write error
  void append_stored(const std::string& shot_id, const std::filesystem::path& capture);

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  /// Its length, the room ahead not counted.
  [[nodiscard]] std::uint64_t bytes() const;

 private:
  void append();
  void make_room(std::uint64_t end);
  void fill_ahead(std::uint64_t end);

  std::filesystem::path path_;
  int file_ = -1;
  mutable std::mutex append_mutex_;  ///< guards the two that follow
  std::vector<std::byte> buffer_;
  std::uint64_t end_ = 0;
  std::mutex room_mutex_;                ///< held while the file grows
  std::atomic<std::uint64_t> room_ = 0;  ///< bytes the file has, used or not
  std::atomic<bool> failed_ = false;
};

/// Damage inside a journal.
struct JournalProblem {
  std::uint64_t offset = 0;
  std::string text;
};

/// What a journal file holds.
struct JournalContents {
  struct Stored {
    std::string shot_id;
    std::string capture;
  };
  std::vector<Shot> shots;
  std::vector<Stored> stored;
  std::uint64_t whole_records = 0;
  std::uint64_t bytes_ignored = 0;  ///< after the last whole record: a write that a crash cut short
  std::vector<JournalProblem>
      problems;  ///< records that changed after they were written: not in `shots`
};

/// @throws InputError if the file is not a journal
[[nodiscard]] JournalContents read_journal(const std::filesystem::path& path);

}  // namespace kolsky
