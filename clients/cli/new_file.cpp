#include "clients/cli/new_file.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>

#include "processing/base/error.hpp"

namespace kolsky::cli {
namespace {

std::string reason_of(int error) {
  return std::generic_category().message(error);
}

bool write_all(int file, const std::string& text) {
  std::size_t written = 0;
  while (written < text.size()) {
    const ssize_t n = ::write(file, text.data() + written, text.size() - written);
    if (n < 0 && errno != EINTR) {
      return false;
    }
    written += n > 0 ? static_cast<std::size_t>(n) : 0;
  }
  return true;
}

}  // namespace

void write_new_file(const std::filesystem::path& path, const std::string& text) {
  const int file = ::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0644);
  if (file < 0) {
    throw InputError(path.string(),
                     errno == EEXIST ? "exists already" : "cannot be written: " + reason_of(errno),
                     errno == EEXIST ? "choose another name or remove it first"
                                     : "choose a folder that exists and can be written");
  }
  const bool written = write_all(file, text);
  const int error = errno;
  const bool closed = ::close(file) == 0;
  if (!written || !closed) {
    ::unlink(path.c_str());
    throw InputError(path.string(), "cannot be written: " + reason_of(written ? errno : error),
                     "make room or choose another folder");
  }
}

}  // namespace kolsky::cli
