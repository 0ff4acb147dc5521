#pragma once

#include <string>
#include <vector>

#include "clients/cli/command.hpp"

namespace kolsky::cli {

/// What every command takes.
struct CommonOptions {
  bool help = false;
  bool json = false;
  std::string endpoint;
};

/// Reads a command's words (without the program's and the command's name) into its targets.
/// With --help nothing else is asked for.
/// @throws InputError naming the word and the nearest option
[[nodiscard]] CommonOptions parse(const Command& command, const std::vector<std::string>& words);

/// What `--help` prints for a command.
[[nodiscard]] std::string help_text(const Command& command);

}  // namespace kolsky::cli
