#include "processing/base/error.hpp"

#include <string_view>
#include <utility>

namespace kolsky {

namespace {

// What is wrong is often quoted, and may hold line ends or a terminal's control codes.
std::string one_line(const std::string& text) {
  constexpr std::string_view kHex = "0123456789abcdef";
  std::string line;
  line.reserve(text.size());
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (c == '\n') {
      line += "\\n";
    } else if (byte < 0x20 || byte == 0x7F) {
      line += {'\\', 'x', kHex[byte >> 4U], kHex[byte & 15U]};
    } else {
      line += c;
    }
  }
  return line;
}

}  // namespace

InputError::InputError(std::string place, std::string what, std::string mend)
    : std::runtime_error(one_line(place + ": " + what + "; " + mend)),
      place_(std::move(place)),
      problem_(std::move(what)),
      mend_(std::move(mend)) {}

InputError InputError::inside(const std::string& outer_place) const {
  return {outer_place + ": " + place_, problem_, mend_};
}

}  // namespace kolsky
