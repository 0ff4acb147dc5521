#pragma once

#include <sys/mman.h>
#include <unistd.h>

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <span>
#include <string>

namespace kolsky::fuzz {

/// A file with a path and no disk under it.
class MemoryFile {
 public:
  explicit MemoryFile(std::span<const std::byte> content)
      : file_(::memfd_create("fuzz", MFD_CLOEXEC)) {
    write(content);
  }
  ~MemoryFile() { ::close(file_); }
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;

  void append(const std::string& text) { write(std::as_bytes(std::span(text))); }
  [[nodiscard]] std::filesystem::path path() const {
    return "/proc/self/fd/" + std::to_string(file_);
  }

 private:
  void write(std::span<const std::byte> bytes) const {
    if (::write(file_, bytes.data(), bytes.size()) != static_cast<ssize_t>(bytes.size())) {
      std::abort();
    }
  }

  int file_;
};

}  // namespace kolsky::fuzz
