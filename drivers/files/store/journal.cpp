#include "drivers/files/store/journal.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <stdexcept>
#include <system_error>

#include "drivers/files/captures/byte_stream.hpp"
#include "drivers/files/captures/new_file.hpp"
#include "drivers/files/captures/shot_codec.hpp"
#include "drivers/files/store/journal_record.hpp"
#include "processing/base/error.hpp"

namespace kolsky {

namespace {

namespace record = journal_record;

/// Overwriting zeros costs fdatasync half of what growing the file costs: no extent changes.
constexpr std::uint64_t kRoomBytes = std::uint64_t{1} << 20U;
constexpr std::uint64_t kLeastRoomBytes = kRoomBytes / 2;

/// @return 0 or what failed
int write_at(int file, std::span<const std::byte> bytes, std::uint64_t offset) {
  while (!bytes.empty()) {
    const ssize_t written = ::pwrite(file, bytes.data(), bytes.size(), static_cast<off_t>(offset));
    if (written < 0 && errno == EINTR) {
      continue;
    }
    if (written < 0) {
      return errno;
    }
    bytes = bytes.subspan(static_cast<std::size_t>(written));
    offset += static_cast<std::uint64_t>(written);
  }
  return 0;
}

std::runtime_error failure(const std::filesystem::path& path, const std::string& what, int error) {
  return std::runtime_error(path.string() + ": " + what + " (" +
                            std::system_category().message(error) + ")");
}

}  // namespace

Journal::Journal(const std::filesystem::path& path) : path_(path) {
  file_ = ::open(path.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0644);
  if (file_ < 0 && errno == EEXIST) {
    throw InputError(path.string(), "exists already",
                     "give each start of the daemon its own journal");
  }
  if (file_ < 0) {
    throw InputError(path.string(),
                     "cannot be made (" + std::system_category().message(errno) + ")",
                     "check the folder and its permissions");
  }
  try {
    fill_ahead(0);
    record::begin(buffer_);
    ByteWriter writer(buffer_);
    writer.put(record::kFormat);
    writer.put_text(KOLSKY_VERSION);
    record::finish(record::Kind::opened, buffer_);
    append();
    make_durable();
    sync_folder(path.has_parent_path() ? path.parent_path() : std::filesystem::path("."));
  } catch (const std::runtime_error& error) {
    ::close(file_);
    ::unlink(path.c_str());
    throw InputError(path.string(), std::string("cannot be written: ") + error.what(),
                     "check the folder and the space on the disk");
  }
}

Journal::~Journal() {
  // Best effort: room that stays costs space, nothing else.
  [[maybe_unused]] const int ignored = ::ftruncate(file_, static_cast<off_t>(end_));
  ::close(file_);
}

void Journal::write_shot(const Shot& shot) {
  check_storable(shot);
  const std::scoped_lock lock(append_mutex_);
  record::begin(buffer_);
  encode_shot(shot, buffer_);
  record::finish(record::Kind::shot, buffer_);
  append();
}

void Journal::make_durable() {
  // Linux tells a file's write error once: it may have told it to `fill_ahead`.
  const bool told_before = failed_;
  const int error = ::fdatasync(file_) == 0 ? 0 : errno;
  if (error != 0 || told_before) {
    failed_ = true;
    throw failure(path_, "a record cannot be made durable", error != 0 ? error : EIO);
  }
}

void Journal::append_shot(const Shot& shot) {
  write_shot(shot);
  make_durable();
}

void Journal::append_stored(const std::string& shot_id, const std::filesystem::path& capture) {
  std::uint64_t end = 0;
  {
    const std::scoped_lock lock(append_mutex_);
    record::begin(buffer_);
    ByteWriter writer(buffer_);
    writer.put_text(shot_id);
    writer.put_text(capture.string());
    record::finish(record::Kind::stored, buffer_);
    append();
    end = end_;
  }
  fill_ahead(end);
}

std::uint64_t Journal::bytes() const {
  const std::scoped_lock lock(append_mutex_);
  return end_;
}

void Journal::append() {
  if (failed_) {
    throw std::runtime_error(path_.string() + ": takes no more after a write error");
  }
  make_room(end_ + buffer_.size());
  if (const int error = write_at(file_, buffer_, end_); error != 0) {
    // What did get written would stand before the next record as damage.
    const std::scoped_lock lock(room_mutex_);
    failed_ = ::ftruncate(file_, static_cast<off_t>(end_)) != 0;
    room_ = end_;
    throw failure(path_, "a record cannot be written", error);
  }
  end_ += buffer_.size();
}

void Journal::make_room(std::uint64_t end) {
  if (end <= room_) {
    return;
  }
  const std::scoped_lock lock(room_mutex_);
  if (end > room_) {
    // In one piece where the file system can; where it cannot, writing grows the file.
    ::fallocate(file_, 0, static_cast<off_t>(room_.load()), static_cast<off_t>(end - room_));
    room_ = end;
  }
}

void Journal::fill_ahead(std::uint64_t end) {
  const std::scoped_lock lock(room_mutex_);
  if (room_ >= end + kLeastRoomBytes) {
    return;
  }
  const std::vector<std::byte> zeros(kRoomBytes);
  if (write_at(file_, zeros, room_) != 0) {
    return;  // a full disk shows when a record needs the space
  }
  if (::fdatasync(file_) != 0) {
    failed_ = true;
    return;
  }
  room_ += kRoomBytes;
}

}  // namespace kolsky
