#include "drivers/files/captures/capture_seal.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <string_view>
#include <system_error>
#include <vector>

#include "drivers/files/sha256.hpp"
#include "processing/base/error.hpp"

namespace kolsky {

namespace {

constexpr std::string_view kPrefix = "\nKOLSKY CAPTURE SEAL 1 sha256 ";
constexpr std::size_t kSealBytes = kPrefix.size() + 64 + 1;
/// HDF5's signature, and the version of its format from which objects carry checksums: what Kolsky
/// writes.
constexpr std::string_view kHdf5Signature = "\x89HDF\r\n\x1a\n\x02";

std::string seal_line(const std::string& digest) {
  return std::string(kPrefix) + digest + "\n";
}

/// A regular file opened for reading from its start.
class InputFile {
 public:
  explicit InputFile(const std::filesystem::path& path) : path_(path) {
    // Non-blocking, so that a pipe under the name does not hang the program.
    file_ = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    struct stat status {};
    if (file_ < 0 || ::fstat(file_, &status) != 0) {
      refuse(std::system_category().message(errno));
    }
    if (!S_ISREG(status.st_mode)) {
      ::close(file_);
      file_ = -1;
      refuse("it is not a regular file");
    }
    size_ = static_cast<std::uint64_t>(status.st_size);
  }
  ~InputFile() {
    if (file_ >= 0) {
      ::close(file_);
    }
  }
  InputFile(const InputFile&) = delete;
  InputFile& operator=(const InputFile&) = delete;

  [[nodiscard]] std::uint64_t size() const { return size_; }

  [[nodiscard]] std::span<const std::byte> read(std::uint64_t most) {
    buffer_.resize(static_cast<std::size_t>(std::min<std::uint64_t>(most, kChunkBytes)));
    const ssize_t count = ::read(file_, buffer_.data(), buffer_.size());
    if (count <= 0) {
      refuse(count < 0 ? std::system_category().message(errno) : "it ends while it is read");
    }
    return std::span(buffer_).first(static_cast<std::size_t>(count));
  }

 private:
  static constexpr std::uint64_t kChunkBytes = 1U << 20U;

  [[noreturn]] void refuse(const std::string& why) const {
    throw InputError(path_.string(), "cannot be read (" + why + ")", "name a capture (.h5)");
  }

  std::filesystem::path path_;
  int file_ = -1;
  std::uint64_t size_ = 0;
  std::vector<std::byte> buffer_;
};

}  // namespace

std::string seal_of(std::span<const std::byte> content) {
  return seal_line(sha256_hex(content));
}

std::uint64_t check_seal(const std::filesystem::path& path) {
  InputFile file(path);
  const auto refuse = [&path](const std::string& what, const std::string& mend) {
    throw InputError(path.string(), what, mend);
  };
  const std::uint64_t content = file.size() - std::min<std::uint64_t>(file.size(), kSealBytes);
  Sha256 hash;
  for (std::uint64_t done = 0; done < content;) {
    const auto bytes = file.read(content - done);
    const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    if (done == 0 && !text.starts_with(kHdf5Signature)) {
      refuse("is not a capture",
             "name a file that Kolsky wrote; `kolsky import csv` makes one of a table");
    }
    hash.add(bytes);
    done += bytes.size();
  }
  std::string tail;
  while (tail.size() < file.size() - content) {
    const auto bytes = file.read(file.size() - content - tail.size());
    tail.append(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  }
  if (content == 0 || !tail.starts_with(kPrefix)) {
    refuse("has no seal at its end: it is cut short, was edited, or is not a capture",
           "take it from a backup; captures are never edited in place");
  }
  if (tail != seal_line(hash.hex())) {
    refuse("has changed since it was written (SHA-256 of the whole file)",
           "take it from a backup, or move it away and let the journal restore it");
  }
  return content;
}

}  // namespace kolsky
