#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "processing/base/shot.hpp"

namespace kolsky {

/// The truth about a shot until its capture is durable: an append-only file of checksummed records,
/// `store/journal/<boot>.kj`. A record is whole or it is not there; whatever a crash leaves at the end is
/// ignored. Little endian: magic "KJR1", kind u32, payload bytes u64, XXH3-64 of header fields and
/// payload, payload.
class Journal {
 public:
  /// Makes a new file. @throws InputError if it exists or the folder cannot be written
  explicit Journal(const std::filesystem::path& path);
  ~Journal();
  Journal(const Journal&) = delete;
  Journal& operator=(const Journal&) = delete;

  /// Appends the shot and returns when it is durable. @throws std::runtime_error on a write error
  void append_shot(const Shot& shot);

  /// Says that the capture of this shot is durable at `capture`.
  void append_stored(const std::string& shot_id, const std::filesystem::path& capture);

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
  int file_ = -1;
  std::vector<std::byte> buffer_;
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
};

/// @throws InputError if the file is not a journal
[[nodiscard]] JournalContents read_journal(const std::filesystem::path& path);

}  // namespace kolsky
