#include <vector>

#include "drivers/files/store/journal.hpp"
#include "drivers/files/store/journal_record.hpp"
#include "processing/base/error.hpp"
#include "tests/fuzz/memory_file.hpp"

namespace {

void read(std::span<const std::byte> content) {
  const kolsky::fuzz::MemoryFile file(content);
  try {
    (void)kolsky::read_journal(file.path());
  } catch (const kolsky::InputError&) {
  }
}

}  // namespace

/// The bytes as a journal file, then as the payload of an undamaged record: past the checksums,
/// where only the shot's own bounds checks are left.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto bytes = std::as_bytes(std::span(data, size));
  read(bytes);
  std::vector<std::byte> record;
  kolsky::journal_record::begin(record);
  record.insert(record.end(), bytes.begin(), bytes.end());
  kolsky::journal_record::finish(kolsky::journal_record::Kind::shot, record);
  read(record);
  return 0;
}
