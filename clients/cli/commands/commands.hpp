#pragma once

#include <vector>

#include "clients/cli/command.hpp"

namespace kolsky::cli {

/// Every command of the program, in the order --help lists them. A new one is a file here, with its
/// line in commands.cpp.
[[nodiscard]] std::vector<Command> all_commands();

}  // namespace kolsky::cli
