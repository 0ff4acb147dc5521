#pragma once

#include <iio.h>

#include <optional>
#include <string>

namespace kolsky {

/// An attribute of a device, or of a channel where `channel` is set.
struct AttributeOwner {
  const iio_device* device = nullptr;
  const iio_channel* channel = nullptr;

  [[nodiscard]] bool has(const char* name) const;
  /// "voltage0", or the device's id.
  [[nodiscard]] std::string id() const;
};

/// The text of an attribute without the white space at its end; none where it is absent or
/// unreadable.
[[nodiscard]] std::optional<std::string> read_text(const AttributeOwner& owner, const char* name);

/// The number that an attribute's text shows, as a double: libiio's own copy of the scale is parsed
/// as a float. @throws InputError, placed at the attribute, where the text is no finite number
[[nodiscard]] std::optional<double> read_number(const AttributeOwner& owner, const char* name);

/// @return 0 or a negative errno
[[nodiscard]] long write_text(const AttributeOwner& owner, const char* name,
                              const std::string& text);

/// Digits that a device's own parser takes: no exponent, no trailing zeros.
[[nodiscard]] std::string plain_number(double value);

}  // namespace kolsky
