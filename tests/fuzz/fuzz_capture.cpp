#include "drivers/files/captures/capture.hpp"
#include "drivers/files/captures/capture_seal.hpp"
#include "processing/base/error.hpp"
#include "tests/fuzz/memory_file.hpp"

/// The bytes as a file, then with the seal of someone who knows it, so that HDF5 sees them.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto content = std::as_bytes(std::span(data, size));
  kolsky::fuzz::MemoryFile file(content);
  for (const bool sealed : {false, true}) {
    try {
      if (sealed) {
        file.append(kolsky::seal_of(content));
      }
      (void)kolsky::read_capture(file.path());
    } catch (const kolsky::InputError&) {
    }
  }
  return 0;
}
