#pragma once

#include <charconv>
#include <optional>
#include <string>
#include <string_view>

namespace kolsky {

/// The shortest text that reads back to the same number; whole numbers have no exponent.
[[nodiscard]] inline std::string number_text(double number) {
  char text[64];
  const bool plain = number > -1e15 && number < 1e15 &&
                     number == static_cast<double>(static_cast<long long>(number));
  const auto end = plain ? std::to_chars(text, text + sizeof text, static_cast<long long>(number))
                         : std::to_chars(text, text + sizeof text, number);
  return {text, end.ptr};
}

/// The number that the whole text is, or nothing.
template <typename Number>
[[nodiscard]] std::optional<Number> parse_number(std::string_view text) {
  Number number{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc{} || end != text.data() + text.size()) {
    return std::nullopt;
  }
  return number;
}

}  // namespace kolsky
