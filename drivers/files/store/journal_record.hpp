#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

/// The form of a journal's records; docs/capture-format.md describes it. Records begin at multiples
/// of 64 bytes, so that a header lies in one sector and no crash can cut it in two.
namespace kolsky::journal_record {

enum class Kind : std::uint32_t { opened = 0, shot = 1, stored = 2 };

inline constexpr std::uint32_t kFormat = 1;
inline constexpr std::size_t kAlignment = 64;
inline constexpr std::size_t kHeaderBytes = 32;
inline constexpr std::size_t kEndMarkBytes = 8;

struct Header {
  std::uint32_t kind = 0;
  std::uint64_t payload_bytes = 0;
  std::uint64_t payload_hash = 0;  ///< XXH3-64

  [[nodiscard]] std::uint64_t record_bytes() const;
};

/// Makes room for a header at the front of an empty buffer; the payload is appended behind it.
void begin(std::vector<std::byte>& record);
/// Completes a record: padding, end mark and, now that the payload is known, the header.
void finish(Kind kind, std::vector<std::byte>& record);

/// @return nothing where the bytes are no undamaged header
[[nodiscard]] std::optional<Header> parse_header(std::span<const std::byte, kHeaderBytes> bytes);

enum class Body {
  whole,
  damaged,    ///< written to its end, and changed since
  cut_short,  ///< its end was never written
};

/// Judges what follows a header, as far as the file has it.
[[nodiscard]] Body judge_body(const Header& header, std::span<const std::byte> body);

}  // namespace kolsky::journal_record
