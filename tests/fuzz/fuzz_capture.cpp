#include "drivers/files/capture.hpp"
#include "drivers/files/capture_seal.hpp"
#include "processing/base/error.hpp"
#include "tests/fuzz/memory_file.hpp"

/// The bytes as a file, then with the seal of someone who knows it, so that HDF5 sees them.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  kolsky::fuzz::MemoryFile file(std::as_bytes(std::span(data, size)));
  for (const bool sealed : {false, true}) {
    try {
      if (sealed) {
        file.append(kolsky::seal_of_file(file.path()));
      }
      (void)kolsky::read_capture(file.path());
    } catch (const kolsky::InputError&) {
    }
  }
  return 0;
}
