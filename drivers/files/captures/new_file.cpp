#include "drivers/files/captures/new_file.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <fstream>
#include <system_error>
#include <utility>
#include <vector>

#include "processing/base/error.hpp"

namespace kolsky {

namespace {

constexpr std::string_view kSuffix = ".part";

std::string reason(int error) {
  return std::system_category().message(error);
}

std::filesystem::path folder_of(const std::filesystem::path& path) {
  return path.has_parent_path() ? path.parent_path() : std::filesystem::path(".");
}

InputError taken(const std::filesystem::path& path) {
  return {path.string(), "exists already", "give another name: nothing stored is overwritten"};
}

InputError unwritable(const std::filesystem::path& path, int error) {
  return {path.string(), "cannot be written (" + reason(error) + ")",
          "check the folder, its permissions and the space on the disk"};
}

/// 0, or what renaming failed with. File systems without an exclusive rename get link and unlink.
int rename_exclusively(const std::filesystem::path& from, const std::filesystem::path& to) {
  if (::renameat2(AT_FDCWD, from.c_str(), AT_FDCWD, to.c_str(), RENAME_NOREPLACE) == 0) {
    return 0;
  }
  if (errno != EINVAL && errno != ENOSYS) {
    return errno;
  }
  if (::link(from.c_str(), to.c_str()) != 0) {
    return errno;
  }
  ::unlink(from.c_str());
  return 0;
}

bool is_abandoned_name(const std::string& name) {
  return name.size() > kSuffix.size() && name.front() == '.' && name.ends_with(kSuffix);
}

/// A file beside another, to be put in its place.
struct Replacement {
  std::string name;
  int file = -1;

  explicit Replacement(const std::filesystem::path& path)
      : name((folder_of(path) / ".kolsky-replacing-XXXXXX").string()),
        file(::mkostemp(name.data(), O_CLOEXEC)) {
    if (file < 0) {
      throw unwritable(path, errno);
    }
  }
};

// A model, a page and a picture each begin in their own way.
void refuse_other_kind(const std::filesystem::path& path, const std::string& text) {
  constexpr std::size_t kTelling = 5;
  if (std::error_code ignored; std::filesystem::is_directory(path, ignored)) {
    throw unwritable(path, EISDIR);
  }
  std::ifstream there(path, std::ios::binary);
  std::string begin(kTelling, '\0');
  if (!there || !there.read(begin.data(), kTelling)) {
    return;  // nothing is lost
  }
  if (text.compare(0, kTelling, begin) != 0) {
    throw InputError(path.string(), "is there already and something else; it is not overwritten",
                     "give another name");
  }
}

}  // namespace

NewFile::NewFile(std::filesystem::path path) : path_(std::move(path)) {
  std::error_code ignored;
  if (std::filesystem::exists(std::filesystem::symlink_status(path_, ignored))) {
    throw taken(path_);
  }
  std::string name = (folder_of(path_) / ("." + path_.filename().string() + ".XXXXXX")).string();
  name += kSuffix;
  file_ = ::mkostemps(name.data(), static_cast<int>(kSuffix.size()), O_CLOEXEC | O_APPEND);
  if (file_ < 0) {
    throw unwritable(path_, errno);
  }
  temporary_ = name;
  ::flock(file_, LOCK_EX | LOCK_NB);  // says that it is not abandoned
}

NewFile::~NewFile() {
  if (!temporary_.empty()) {
    ::unlink(temporary_.c_str());
  }
  if (file_ >= 0) {
    ::close(file_);
  }
}

void NewFile::write(std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(file_, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) {
      continue;
    }
    if (written < 0) {
      throw unwritable(path_, errno);
    }
    bytes = bytes.subspan(static_cast<std::size_t>(written));
  }
}

void NewFile::write(const std::string& text) {
  write(std::as_bytes(std::span(text)));
}

void NewFile::publish(mode_t mode) {
  if (::fchmod(file_, mode) != 0 || ::fsync(file_) != 0) {
    throw unwritable(path_, errno);
  }
  if (const int error = rename_exclusively(temporary_, path_); error != 0) {
    throw error == EEXIST ? taken(path_) : unwritable(path_, error);
  }
  temporary_.clear();
  sync_folder(folder_of(path_));
}

bool rename_without_overwriting(const std::filesystem::path& from,
                                const std::filesystem::path& to) {
  const int error = rename_exclusively(from, to);
  if (error == EEXIST) {
    return false;
  }
  if (error != 0) {
    throw unwritable(to, error);
  }
  sync_folder(folder_of(to));
  return true;
}

void require_replaceable(const std::filesystem::path& path, const std::string& beginning) {
  refuse_other_kind(path, beginning);
  const Replacement tried(path);
  ::close(tried.file);
  ::unlink(tried.name.c_str());
}

void replace_file(const std::filesystem::path& path, const std::string& text) {
  refuse_other_kind(path, text);
  const auto [name, file] = Replacement(path);
  std::size_t written = 0;
  int error = 0;
  while (written < text.size() && error == 0) {
    const ssize_t count = ::write(file, text.data() + written, text.size() - written);
    if (count >= 0) {
      written += static_cast<std::size_t>(count);
    } else if (errno != EINTR) {
      error = errno;
    }
  }
  constexpr mode_t kReadableByAll = 0644;
  if (error == 0 && (::fchmod(file, kReadableByAll) != 0 || ::fsync(file) != 0 ||
                     ::rename(name.c_str(), path.c_str()) != 0)) {
    error = errno;
  }
  ::close(file);
  if (error != 0) {
    ::unlink(name.c_str());
    throw unwritable(path, error);
  }
  sync_folder(folder_of(path));
}

void sync_folder(const std::filesystem::path& folder) {
  const int descriptor = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  const bool synced = descriptor >= 0 && ::fsync(descriptor) == 0;
  const int error = errno;
  if (descriptor >= 0) {
    ::close(descriptor);
  }
  if (!synced) {
    throw unwritable(folder, error);
  }
}

std::size_t remove_abandoned_files(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> candidates;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (is_abandoned_name(entry.path().filename().string()) && entry.is_regular_file()) {
      candidates.push_back(entry.path());
    }
  }
  std::size_t removed = 0;
  for (const auto& path : candidates) {
    const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW);
    if (descriptor < 0) {
      continue;
    }
    if (::flock(descriptor, LOCK_EX | LOCK_NB) == 0 && ::unlink(path.c_str()) == 0) {
      ++removed;
    }
    ::close(descriptor);
  }
  return removed;
}

}  // namespace kolsky
