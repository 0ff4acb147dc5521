#include "drivers/digitiser/library_messages.hpp"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>
#include <string_view>

namespace kolsky {

namespace {

bool is_of_libiio(std::string_view text) {
  constexpr std::array<std::string_view, 2> kBeginnings{"ERROR: ", "WARNING: "};
  return std::any_of(kBeginnings.begin(), kBeginnings.end(),
                     [&](std::string_view beginning) { return text.starts_with(beginning); });
}

/// The stream has no buffer: a message comes whole.
ssize_t write_others(void*, const char* text, std::size_t size) {
  if (is_of_libiio({text, size})) {
    return static_cast<ssize_t>(size);
  }
  std::size_t written = 0;
  while (written < size) {
    const ssize_t count = ::write(STDERR_FILENO, text + written, size - written);
    if (count < 0 && errno != EINTR) {
      return 0;
    }
    written += count > 0 ? static_cast<std::size_t>(count) : 0;
  }
  return static_cast<ssize_t>(size);
}

}  // namespace

void leave_out_libiio_messages() {
  cookie_io_functions_t functions{};
  functions.write = write_others;
  if (std::FILE* filtered = ::fopencookie(nullptr, "w", functions)) {
    (void)std::setvbuf(filtered, nullptr, _IONBF, 0);
    stderr = filtered;
  }
}

}  // namespace kolsky
