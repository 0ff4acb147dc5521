#include "drivers/files/settings/file_bytes.hpp"

#include <cerrno>
#include <cstdio>
#include <memory>
#include <string>
#include <system_error>

#include "processing/base/error.hpp"

namespace kolsky {

namespace {

struct CloseFile {
  void operator()(std::FILE* file) const { (void)std::fclose(file); }
};

// Devices and pipes can be endless or never answer; a stored measurement is a file.
void require_regular_file(const std::filesystem::path& path) {
  std::error_code error;
  const auto status = std::filesystem::status(path, error);
  if (status.type() == std::filesystem::file_type::not_found) {
    throw InputError(path.string(), "there is no such file", "check the path");
  }
  if (error) {
    throw InputError(path.string(), "cannot be looked at: " + error.message(), "check the path");
  }
  if (!std::filesystem::is_regular_file(status)) {
    throw InputError(path.string(), "is not a file", "give the path of a file");
  }
}

std::string errno_text() {
  return std::generic_category().message(errno);
}

}  // namespace

std::string read_file_bytes(const std::filesystem::path& path, std::size_t most_bytes) {
  require_regular_file(path);
  const std::unique_ptr<std::FILE, CloseFile> file(std::fopen(path.c_str(), "rb"));
  if (!file) {
    throw InputError(path.string(), "cannot be opened: " + errno_text(), "make it readable");
  }
  std::error_code error;
  const std::uintmax_t size = std::filesystem::file_size(path, error);
  if (error || size > most_bytes) {
    throw InputError(path.string(), "is larger than " + std::to_string(most_bytes) + " bytes",
                     "check that this is the file you mean");
  }
  std::string bytes(static_cast<std::size_t>(size), '\0');
  const std::size_t got = std::fread(bytes.data(), 1, bytes.size(), file.get());
  if (std::ferror(file.get()) != 0) {
    throw InputError(path.string(), "cannot be read: " + errno_text(), "check the disk");
  }
  bytes.resize(got);
  return bytes;
}

}  // namespace kolsky
