#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "clients/figure/text_columns.hpp"

namespace kolsky {

/// What text goes to.
struct Terminal {
  bool interactive = false;  ///< a terminal, not a file or a pipe
  bool colour = false;       ///< interactive, and NO_COLOR is not set
  int columns = 80;
  int rows = 24;
};

/// Asks the system about a file descriptor. What is not a terminal has 80 columns and no colour.
[[nodiscard]] Terminal terminal_of(int file_descriptor);

enum class Ink { plain, dim, bold, good, doubtful, bad, first, second, third };

/// The ink of the n-th line of a plot.
[[nodiscard]] Ink series_ink(std::size_t n);

/// `text` in ink where colour is wanted, else as it is.
[[nodiscard]] std::string inked(std::string_view text, Ink ink, bool colour);

/// The text padded with blanks on the right (or left) to a width.
[[nodiscard]] std::string padded_right(std::string_view text, std::size_t columns);
[[nodiscard]] std::string padded_left(std::string_view text, std::size_t columns);

/// Words as a list, with commas between.
[[nodiscard]] std::string joined(const std::vector<std::string>& words);

}  // namespace kolsky
