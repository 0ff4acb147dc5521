#pragma once

#include <bit>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include "processing/base/error.hpp"

namespace kolsky {

static_assert(std::endian::native == std::endian::little,
              "stored numbers are little endian and copied as they are");

/// Appends numbers and texts to bytes.
class ByteWriter {
 public:
  explicit ByteWriter(std::vector<std::byte>& out) : out_(out) {}

  template <typename Number>
  requires std::is_arithmetic_v<Number>
  void put(Number number) { put_bytes(std::as_bytes(std::span(&number, 1))); }
  void put_text(const std::string& text) {
    put(static_cast<std::uint32_t>(text.size()));
    put_bytes(std::as_bytes(std::span(text)));
  }
  void put_bytes(std::span<const std::byte> bytes) {
    out_.insert(out_.end(), bytes.begin(), bytes.end());
  }

 private:
  std::vector<std::byte>& out_;
};

/// Takes them off again and refuses to go past the end.
class ByteReader {
 public:
  ByteReader(std::span<const std::byte> bytes, std::string place)
      : bytes_(bytes), place_(std::move(place)) {}

  template <typename Number>
  requires std::is_arithmetic_v<Number>
  [[nodiscard]] Number get() {
    Number number{};
    std::memcpy(&number, get_bytes(sizeof(Number)).data(), sizeof(Number));
    return number;
  }
  [[nodiscard]] std::string get_text() {
    const auto bytes = get_bytes(get<std::uint32_t>());
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
  }
  [[nodiscard]] std::span<const std::byte> get_bytes(std::uint64_t count) {
    require(count);
    const auto taken = bytes_.first(static_cast<std::size_t>(count));
    bytes_ = bytes_.subspan(taken.size());
    return taken;
  }
  /// How many items of a list follow, each of at least `least_bytes`: refused before room is made
  /// for them.
  [[nodiscard]] std::uint32_t get_count(std::size_t least_bytes) {
    const auto count = get<std::uint32_t>();
    require(std::uint64_t{count} * least_bytes);
    return count;
  }
  [[nodiscard]] bool get_flag() {
    const auto flag = get<std::uint8_t>();
    if (flag > 1) {
      refuse("a yes-or-no byte holds " + std::to_string(flag));
    }
    return flag == 1;
  }
  void expect_end() const {
    if (!bytes_.empty()) {
      refuse(std::to_string(bytes_.size()) + " bytes are left over");
    }
  }
  [[noreturn]] void refuse(const std::string& what) const {
    throw InputError(place_, what, "take the file from a backup, or use the Kolsky that wrote it");
  }

 private:
  void require(std::uint64_t count) const {
    if (count > bytes_.size()) {
      refuse("ends before its content does");
    }
  }

  std::span<const std::byte> bytes_;
  std::string place_;
};

}  // namespace kolsky
