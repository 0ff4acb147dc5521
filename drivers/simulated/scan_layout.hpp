#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "processing/base/time.hpp"

namespace kolsky {

/// Where the enabled elements of a scan stand, as the kernel lays them out: each at a multiple of
/// its own size, the scan a multiple of the largest.
class ScanLayout {
 public:
  struct Element {
    std::size_t channel = 0;
    std::size_t offset = 0;
    std::size_t bytes = 0;
  };

  ScanLayout() = default;

  /// @param mask           bit i enables element i; word 0 holds elements 0 to 31
  /// @param element_bytes  of each scan element
  ScanLayout(std::vector<std::uint32_t> mask, const std::vector<std::size_t>& element_bytes);

  [[nodiscard]] const std::vector<std::uint32_t>& mask() const noexcept { return mask_; }
  /// As IIOD writes it: 8 hexadecimal digits a word, the highest word first.
  [[nodiscard]] std::string mask_text() const;
  [[nodiscard]] const std::vector<Element>& elements() const noexcept { return elements_; }
  [[nodiscard]] std::size_t bytes() const noexcept { return bytes_; }

  /// Puts codes into their places of consecutive scans. @pre scans.size() == codes.size() * bytes()
  void place(const Element& element, std::span<const std::int32_t> codes,
             std::span<std::byte> scans) const;

  /// The same for a running count, modulo 2^32.
  void place_count(const Element& element, Tick first, std::span<std::byte> scans) const;

 private:
  std::vector<std::uint32_t> mask_;
  std::vector<Element> elements_;
  std::size_t bytes_ = 0;
};

/// Whether the mask enables the element.
[[nodiscard]] bool enables(const std::vector<std::uint32_t>& mask, std::size_t element);

}  // namespace kolsky
