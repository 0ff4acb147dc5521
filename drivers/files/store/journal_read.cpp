#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <system_error>

#include "drivers/files/captures/byte_stream.hpp"
#include "drivers/files/captures/shot_codec.hpp"
#include "drivers/files/store/journal.hpp"
#include "drivers/files/store/journal_scan.hpp"
#include "processing/base/error.hpp"

namespace kolsky {

namespace {

namespace record = journal_record;

bool is_set(std::byte b) {
  return b != std::byte{0};
}

bool all_zero(std::span<const std::byte> bytes) {
  return std::none_of(bytes.begin(), bytes.end(), is_set);
}

/// A file read at any offset, its size taken once.
class RandomAccessFile {
 public:
  explicit RandomAccessFile(const std::filesystem::path& path) : path_(path) {
    file_ = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    struct stat status {};
    if (file_ < 0 || ::fstat(file_, &status) != 0 || !S_ISREG(status.st_mode)) {
      const std::string why =
          file_ < 0 ? std::system_category().message(errno) : "it is not a regular file";
      if (file_ >= 0) {
        ::close(file_);
      }
      throw InputError(path.string(), "cannot be read (" + why + ")", "name a journal (.kj)");
    }
    size_ = static_cast<std::uint64_t>(status.st_size);
  }
  ~RandomAccessFile() { ::close(file_); }
  RandomAccessFile(const RandomAccessFile&) = delete;
  RandomAccessFile& operator=(const RandomAccessFile&) = delete;

  [[nodiscard]] std::uint64_t size() const { return size_; }

  /// As much of the range as the file has; until the next call.
  [[nodiscard]] std::span<const std::byte> read(std::uint64_t offset, std::uint64_t count) {
    const std::uint64_t there = offset < size_ ? std::min(count, size_ - offset) : 0;
    buffer_.resize(static_cast<std::size_t>(there));
    std::size_t done = 0;
    while (done < buffer_.size()) {
      const ssize_t got = ::pread(file_, buffer_.data() + done, buffer_.size() - done,
                                  static_cast<off_t>(offset + done));
      if (got < 0 && errno == EINTR) {
        continue;
      }
      if (got < 0) {
        throw InputError(path_.string(),
                         "cannot be read (" + std::system_category().message(errno) + ")",
                         "check the disk");
      }
      if (got == 0) {
        buffer_.resize(done);  // a writer trimmed it meanwhile
        break;
      }
      done += static_cast<std::size_t>(got);
    }
    return buffer_;
  }

 private:
  std::filesystem::path path_;
  int file_ = -1;
  std::uint64_t size_ = 0;
  std::vector<std::byte> buffer_;
};

/// One pass over a journal, from record to record and over what is damaged between them.
class Scanner {
 public:
  Scanner(const std::filesystem::path& path, const std::function<void(const JournalRecord&)>& visit)
      : path_(path), file_(path), visit_(visit) {}

  JournalScan run() {
    bool any_header = false;
    std::uint64_t offset = 0;
    while (offset < file_.size()) {
      const auto header = header_at(offset);
      any_header = any_header || header.has_value();
      offset = header ? take(*header, offset) : skip_to_header(offset);
    }
    if (!any_header && !scan_.problems.empty()) {
      throw InputError(path_.string(), "is not a journal",
                       "name a file that the daemon wrote (.kj)");
    }
    return std::move(scan_);
  }

 private:
  std::optional<record::Header> header_at(std::uint64_t offset) {
    const auto bytes = file_.read(offset, record::kHeaderBytes);
    if (bytes.size() < record::kHeaderBytes) {
      return std::nullopt;
    }
    return record::parse_header(bytes.first<record::kHeaderBytes>());
  }

  /// @return where the next record should begin
  std::uint64_t take(const record::Header& header, std::uint64_t offset) {
    const std::uint64_t next = offset + header.record_bytes();
    const auto body =
        file_.read(offset + record::kHeaderBytes, next - offset - record::kHeaderBytes);
    switch (record::judge_body(header, body)) {
      case record::Body::whole:
        deliver(header, offset, body.first(static_cast<std::size_t>(header.payload_bytes)));
        return next;
      case record::Body::damaged:
        report(offset, "a record has changed since it was written (checksum)");
        return next;
      case record::Body::cut_short:
        break;
    }
    return pass_cut_short(offset);
  }

  /// A record without its end: what a crash leaves, if it is the last; damage, if others follow.
  std::uint64_t pass_cut_short(std::uint64_t offset) {
    const auto [next, last_used] = find_header(offset + record::kAlignment);
    if (next < file_.size()) {
      report(offset, "a record lacks its end though others follow");
    } else {
      scan_.bytes_ignored += std::min(last_used, file_.size()) - offset;
    }
    return next;
  }

  /// Passes what is no record: damage, or, where zeros go on to the end, the room ahead (with what
  /// a power cut left in it, whose header never reached the disk).
  std::uint64_t skip_to_header(std::uint64_t offset) {
    const bool header_unwritten = all_zero(file_.read(offset, record::kHeaderBytes));
    const auto [next, last_used] = find_header(offset);
    if (next < file_.size() || !header_unwritten) {
      report(offset, "there is no record where one should begin");
    } else {
      scan_.bytes_ignored += last_used - offset;
    }
    return next;
  }

  struct Found {
    std::uint64_t next;       ///< the next header, or the file's end
    std::uint64_t last_used;  ///< behind the last byte before it that is not zero
  };

  Found find_header(std::uint64_t from) {
    constexpr std::uint64_t kChunkBytes = std::uint64_t{1} << 20U;
    std::uint64_t last_used = from;
    for (std::uint64_t chunk = from; chunk < file_.size(); chunk += kChunkBytes) {
      const auto bytes = file_.read(chunk, kChunkBytes);
      for (std::size_t i = 0; i < bytes.size(); i += record::kAlignment) {
        const auto line = bytes.subspan(i, std::min(record::kAlignment, bytes.size() - i));
        if (line.size() >= record::kHeaderBytes &&
            record::parse_header(line.first<record::kHeaderBytes>())) {
          return {chunk + i, last_used};
        }
        const auto used = std::find_if(line.rbegin(), line.rend(), is_set);
        if (used != line.rend()) {
          last_used = chunk + i + static_cast<std::uint64_t>(line.rend() - used);
        }
      }
    }
    return {file_.size(), last_used};
  }

  void deliver(const record::Header& header, std::uint64_t offset,
               std::span<const std::byte> payload) {
    const auto kind = static_cast<record::Kind>(header.kind);
    if (kind == record::Kind::opened) {
      check_format(payload);
    } else if (kind != record::Kind::shot && kind != record::Kind::stored) {
      report(offset, "there is no record kind " + std::to_string(header.kind));
      return;
    }
    ++scan_.whole_records;
    try {
      visit_({kind, offset, payload});
    } catch (const InputError& error) {
      report(offset, error.place() + ": " + error.problem());
    }
  }

  void check_format(std::span<const std::byte> payload) const {
    const auto format = ByteReader(payload, path_.string()).get<std::uint32_t>();
    if (format != record::kFormat) {
      throw InputError(path_.string(), "is a journal of format " + std::to_string(format),
                       "use the Kolsky that wrote it");
    }
  }

  void report(std::uint64_t offset, const std::string& text) {
    scan_.problems.push_back({offset, text});
  }

  std::filesystem::path path_;
  RandomAccessFile file_;
  const std::function<void(const JournalRecord&)>& visit_;
  JournalScan scan_;
};

}  // namespace

JournalScan scan_journal(const std::filesystem::path& path,
                         const std::function<void(const JournalRecord&)>& visit) {
  return Scanner(path, visit).run();
}

Shot journaled_shot(const JournalRecord& record) {
  return decode_shot(record.payload, "shot");
}

JournalContents read_journal(const std::filesystem::path& path) {
  JournalContents contents;
  const auto visit = [&](const JournalRecord& record) {
    if (record.kind == record::Kind::shot) {
      Shot shot = journaled_shot(record);
      attach_bench(shot, "shot " + shot.id + ": bench_toml");
      contents.shots.push_back(std::move(shot));
    } else if (record.kind == record::Kind::stored) {
      ByteReader reader(record.payload, "stored");
      auto& stored = contents.stored.emplace_back();
      stored.shot_id = reader.get_text();
      stored.capture = reader.get_text();
    }
  };
  JournalScan scan = scan_journal(path, visit);
  contents.whole_records = scan.whole_records;
  contents.bytes_ignored = scan.bytes_ignored;
  contents.problems = std::move(scan.problems);
  return contents;
}

}  // namespace kolsky
