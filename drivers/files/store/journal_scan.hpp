#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>

#include "drivers/files/store/journal.hpp"
#include "drivers/files/store/journal_record.hpp"

namespace kolsky {

struct JournalRecord {
  journal_record::Kind kind = journal_record::Kind::opened;
  std::uint64_t offset = 0;
  std::span<const std::byte> payload;  ///< until the next record
};

/// What a pass over a journal leaves beside its records.
struct JournalScan {
  std::uint64_t whole_records = 0;
  std::uint64_t bytes_ignored = 0;
  std::vector<JournalProblem> problems;
};

/// Hands every whole record on, in order, holding one at a time. Damage is reported, and reading
/// goes on at the next record.
/// @throws InputError if the file is not a journal or of a later format
JournalScan scan_journal(const std::filesystem::path& path,
                         const std::function<void(const JournalRecord&)>& visit);

/// The shot of a record of kind `shot`, its bench not yet parsed. @throws InputError
[[nodiscard]] Shot journaled_shot(const JournalRecord& record);

}  // namespace kolsky
