#pragma once

#include <cstdint>
#include <functional>
#include <iosfwd>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "clients/terminal/terminal.hpp"

namespace kolsky::cli {

/// Exit codes of the program.
inline constexpr int kDone = 0;
inline constexpr int kUnexpected = 1;  ///< a defect or the machine's fault
inline constexpr int kRefused = 2;     ///< bad usage or bad input

/// What a command runs in.
struct Context {
  std::ostream& out;
  Terminal terminal;     ///< what `out` goes to
  bool json = false;     ///< one JSON object on `out` and nothing else
  std::string endpoint;  ///< control endpoint of the daemon, for the commands that talk to it
};

/// Where a value from the command line goes. A flag is a bool.
using Target =
    std::variant<bool*, std::string*, std::optional<std::string>*, std::optional<double>*,
                 std::optional<std::uint64_t>*, std::vector<std::string>*>;

struct Argument {
  std::string name;   ///< "CAPTURE" (by position), "--svg" or "-o,--output"
  std::string value;  ///< what --help calls the value: "FILE"
  std::string help;   ///< meaning and unit
  Target target;
  bool required = false;
  std::vector<std::string> choices;  ///< the only values taken, if there are any
};

/// What a command cannot do without.
inline Argument needed(std::string name, std::string value, std::string help, Target target) {
  return {std::move(name), std::move(value), std::move(help), target, true, {}};
}

inline Argument option(std::string name, std::string value, std::string help, Target target) {
  return {std::move(name), std::move(value), std::move(help), target, false, {}};
}

inline Argument flag(std::string name, std::string help, bool* target) {
  return {std::move(name), "", std::move(help), target, false, {}};
}

/// One command: what --help teaches, what it takes, what it does. `--json` (and `--endpoint`, where
/// it uses the daemon) come by themselves.
struct Command {
  std::string name;      ///< "reduce", or in two words "import csv"
  std::string purpose;   ///< two lines; the first stands in the list of commands
  std::string examples;  ///< lines that work as they are
  bool uses_daemon = false;
  std::vector<Argument> arguments;
  std::function<int(Context&)> run;  ///< @return exit code; @throws InputError: exit code 2
};

}  // namespace kolsky::cli
