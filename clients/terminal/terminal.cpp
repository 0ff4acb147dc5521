#include "clients/terminal/terminal.hpp"

#include <sys/ioctl.h>
#include <unistd.h>

#include <array>
#include <cstdlib>

namespace kolsky {
namespace {

std::string_view escape_of(Ink ink) {
  switch (ink) {
    case Ink::plain:
      return "";
    case Ink::dim:
      return "\x1b[2m";
    case Ink::bold:
      return "\x1b[1m";
    case Ink::good:
      return "\x1b[32m";
    case Ink::doubtful:
      return "\x1b[33m";
    case Ink::bad:
      return "\x1b[31m";
    case Ink::first:
      return "\x1b[36m";
    case Ink::second:
      return "\x1b[33m";
    case Ink::third:
      return "\x1b[35m";
  }
  return "";
}

}  // namespace

Terminal terminal_of(int file_descriptor) {
  Terminal terminal;
  terminal.interactive = isatty(file_descriptor) == 1;
  if (!terminal.interactive) {
    return terminal;
  }
  const char* no_colour = std::getenv("NO_COLOR");  // NOLINT(concurrency-mt-unsafe)
  terminal.colour = no_colour == nullptr || *no_colour == '\0';
  winsize size{};
  if (ioctl(file_descriptor, TIOCGWINSZ, &size) == 0 && size.ws_col > 0 && size.ws_row > 0) {
    terminal.columns = size.ws_col;
    terminal.rows = size.ws_row;
  }
  return terminal;
}

Ink series_ink(std::size_t n) {
  constexpr std::array<Ink, 3> kInks = {Ink::first, Ink::second, Ink::third};
  return kInks.at(n % kInks.size());
}

std::string inked(std::string_view text, Ink ink, bool colour) {
  if (!colour || ink == Ink::plain || text.empty()) {
    return std::string(text);
  }
  return std::string(escape_of(ink)).append(text).append("\x1b[0m");
}

std::string padded_right(std::string_view text, std::size_t columns) {
  const std::size_t taken = columns_of(text);
  return std::string(text).append(columns > taken ? columns - taken : 0, ' ');
}

std::string padded_left(std::string_view text, std::size_t columns) {
  const std::size_t taken = columns_of(text);
  return std::string(columns > taken ? columns - taken : 0, ' ').append(text);
}

std::string joined(const std::vector<std::string>& words) {
  std::string list;
  for (const std::string& word : words) {
    list += (list.empty() ? "" : ", ") + word;
  }
  return list;
}

}  // namespace kolsky
