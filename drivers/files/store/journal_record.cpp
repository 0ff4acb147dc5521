#include "drivers/files/store/journal_record.hpp"

#include <xxhash.h>

#include <algorithm>
#include <cstring>

#include "drivers/files/captures/byte_stream.hpp"

namespace kolsky::journal_record {

namespace {

constexpr std::array<char, 4> kMagic{'K', 'J', 'R', '1'};
constexpr std::array<char, kEndMarkBytes> kEndMark{'K', 'J', 'R', '1', '.', 'E', 'N', 'D'};
constexpr std::size_t kHashedHeaderBytes = kHeaderBytes - sizeof(std::uint64_t);
/// No file is larger; keeps sums of sizes from overflowing.
constexpr std::uint64_t kMostPayloadBytes = std::uint64_t{1} << 62U;

std::uint64_t hash_of(std::span<const std::byte> bytes) {
  return XXH3_64bits(bytes.data(), bytes.size());
}

bool all_zero(std::span<const std::byte> bytes) {
  return std::all_of(bytes.begin(), bytes.end(), [](std::byte b) { return b == std::byte{0}; });
}

bool equal(std::span<const std::byte> bytes, std::span<const char> text) {
  return bytes.size() == text.size() && std::memcmp(bytes.data(), text.data(), text.size()) == 0;
}

}  // namespace

std::uint64_t Header::record_bytes() const {
  const std::uint64_t used = kHeaderBytes + payload_bytes + kEndMarkBytes;
  return (used + kAlignment - 1) / kAlignment * kAlignment;
}

void begin(std::vector<std::byte>& record) {
  record.assign(kHeaderBytes, std::byte{0});
}

void finish(Kind kind, std::vector<std::byte>& record) {
  const auto payload = std::span<const std::byte>(record).subspan(kHeaderBytes);
  const Header header{static_cast<std::uint32_t>(kind), payload.size(), hash_of(payload)};
  std::vector<std::byte> front;
  front.reserve(kHeaderBytes);
  ByteWriter writer(front);
  writer.put_bytes(std::as_bytes(std::span(kMagic)));
  writer.put(header.kind);
  writer.put(header.payload_bytes);
  writer.put(header.payload_hash);
  writer.put(hash_of(front));
  std::copy(front.begin(), front.end(), record.begin());
  record.resize(static_cast<std::size_t>(header.record_bytes()) - kEndMarkBytes, std::byte{0});
  ByteWriter(record).put_bytes(std::as_bytes(std::span(kEndMark)));
}

std::optional<Header> parse_header(std::span<const std::byte, kHeaderBytes> bytes) {
  if (!equal(bytes.first(kMagic.size()), kMagic)) {
    return std::nullopt;
  }
  ByteReader reader(bytes.subspan(kMagic.size()), "header");
  Header header;
  header.kind = reader.get<std::uint32_t>();
  header.payload_bytes = reader.get<std::uint64_t>();
  header.payload_hash = reader.get<std::uint64_t>();
  if (reader.get<std::uint64_t>() != hash_of(bytes.first(kHashedHeaderBytes)) ||
      header.payload_bytes > kMostPayloadBytes) {
    return std::nullopt;
  }
  return header;
}

Body judge_body(const Header& header, std::span<const std::byte> body) {
  const std::uint64_t expected = header.record_bytes() - kHeaderBytes;
  if (body.size() < expected) {
    return Body::cut_short;
  }
  const auto end_mark = body.last(kEndMarkBytes);
  if (all_zero(end_mark)) {
    return Body::cut_short;
  }
  const auto payload = body.first(static_cast<std::size_t>(header.payload_bytes));
  const auto padding = body.subspan(payload.size(), body.size() - payload.size() - kEndMarkBytes);
  const bool whole =
      equal(end_mark, kEndMark) && all_zero(padding) && hash_of(payload) == header.payload_hash;
  return whole ? Body::whole : Body::damaged;
}

}  // namespace kolsky::journal_record
