#pragma once

#include <iosfwd>
#include <string>
#include <vector>

#include "clients/terminal/terminal.hpp"

namespace kolsky::cli {

/// The whole program: finds the command among `words` (without the program's name), runs it, and
/// turns what goes wrong into one line on `err` and an exit code.
int run_program(const std::vector<std::string>& words, std::ostream& out, std::ostream& err,
                const Terminal& terminal);

}  // namespace kolsky::cli
