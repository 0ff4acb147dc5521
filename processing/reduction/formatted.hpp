#pragma once

#include <cstdio>
#include <string>

namespace kolsky {

/// As std::printf would print it, for sentences with numbers in them; cut at 255 characters.
template <typename... Numbers>
std::string formatted(const char* format, Numbers... numbers) {
  char buffer[256];
  std::snprintf(buffer, sizeof buffer, format, numbers...);
  return buffer;
}

}  // namespace kolsky
