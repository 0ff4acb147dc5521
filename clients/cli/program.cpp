#include "clients/cli/program.hpp"

#include <algorithm>
#include <ostream>

#include "clients/cli/command.hpp"
#include "clients/cli/commands/commands.hpp"
#include "clients/cli/parse.hpp"
#include "drivers/files/settings/nearest_name.hpp"
#include "processing/base/error.hpp"

namespace kolsky::cli {
namespace {

using Words = std::vector<std::string>;

std::string first_line(const std::string& text) {
  return text.substr(0, text.find('\n'));
}

/// One line for each command that `shown` takes.
template <typename Shown>
std::string list_of(const std::vector<Command>& commands, const Shown& shown) {
  std::size_t columns = 0;
  for (const Command& command : commands) {
    columns = std::max(columns, command.name.size() + 2);
  }
  std::string text;
  for (const Command& command : commands) {
    if (shown(command)) {
      text += "  " + padded_right(command.name, columns) + first_line(command.purpose) + "\n";
    }
  }
  return text;
}

std::string overview(const std::vector<Command>& commands) {
  std::string text =
      "kolsky: from the strain gauges of a split Hopkinson bar to a stress-strain curve.\n\n"
      "Usage: kolsky COMMAND [OPTIONS]\n\nOn files:\n";
  text += list_of(commands, [](const Command& command) { return !command.uses_daemon; });
  text += "\nWith the daemon (--endpoint, or KOLSKY_ENDPOINT):\n";
  text += list_of(commands, [](const Command& command) { return command.uses_daemon; });
  return text +
         "\nEvery command has --help with an example, and --json for scripts. Quantities are in "
         "SI,\n"
         "compression positive. KOLSKY_OPERATOR names the operator; user@host by default. Exit "
         "codes: 0 done, 2 refused (one line says why), 1 anything "
         "else.\n";
}

Words names_of(const std::vector<Command>& commands) {
  Words names;
  for (const Command& command : commands) {
    names.push_back(command.name);
  }
  return names;
}

bool begins_with_name(const Words& words, const Command& command) {
  const std::size_t space = command.name.find(' ');
  if (space == std::string::npos) {
    return words.front() == command.name;
  }
  return words.size() > 1 && words[0] == command.name.substr(0, space) &&
         words[1] == command.name.substr(space + 1);
}

// "import" of "import csv".
bool is_first_word(const std::string& word, const Command& command) {
  return command.name.starts_with(word + " ");
}

bool asks_for_help(const std::string& word) {
  return word == "--help" || word == "-h";
}

/// What `kolsky model --help` says; empty where no command begins with that word.
std::string group_overview(const std::string& word, const std::vector<Command>& commands) {
  const std::string list =
      list_of(commands, [&](const Command& command) { return is_first_word(word, command); });
  return list.empty() ? list : "Usage: kolsky " + word + " ... [OPTIONS]\n\n" + list;
}

[[noreturn]] void refuse_unknown(const Words& words, const std::vector<Command>& commands) {
  Words continued;
  for (const Command& command : commands) {
    if (is_first_word(words.front(), command)) {
      continued.push_back(command.name);
    }
  }
  if (!continued.empty()) {
    const std::string said = words.size() > 1 ? words[0] + " " + words[1] : words[0];
    throw InputError("kolsky", "\"" + said + "\" is not a command",
                     "did you mean " + nearest_name(said, continued) + "? kolsky --help lists all");
  }
  throw InputError("kolsky", "\"" + words.front() + "\" is not a command",
                   "did you mean " + nearest_name(words.front(), names_of(commands)) +
                       "? kolsky --help lists all");
}

const Command& find(const Words& words, const std::vector<Command>& commands) {
  const auto found = std::find_if(commands.begin(), commands.end(), [&](const Command& command) {
    return begins_with_name(words, command);
  });
  if (found == commands.end()) {
    refuse_unknown(words, commands);
  }
  return *found;
}

int run_command(const Command& command, const Words& words, std::ostream& out,
                const Terminal& terminal) {
  const std::size_t name_words = command.name.find(' ') == std::string::npos ? 1 : 2;
  const CommonOptions options =
      parse(command, Words(words.begin() + static_cast<std::ptrdiff_t>(name_words), words.end()));
  if (options.help) {
    out << help_text(command);
    return kDone;
  }
  Context context{out, terminal, options.json, options.endpoint};
  return command.run(context);
}

int dispatch(const Words& words, std::ostream& out, const Terminal& terminal) {
  const std::vector<Command> commands = all_commands();
  if (words.empty()) {
    throw InputError("kolsky", "no command given", "kolsky --help lists them");
  }
  if (asks_for_help(words.front()) || words.front() == "help") {
    out << overview(commands);
    return kDone;
  }
  if (words.size() == 2 && asks_for_help(words[1])) {
    if (const std::string group = group_overview(words[0], commands); !group.empty()) {
      out << group;
      return kDone;
    }
  }
  if (words.front() == "--version") {
    out << "kolsky " << KOLSKY_VERSION << "\n";
    return kDone;
  }
  return run_command(find(words, commands), words, out, terminal);
}

void print_line(std::ostream& err, std::string text) {
  std::replace(text.begin(), text.end(), '\n', ' ');
  err << text << "\n";
}

}  // namespace

int run_program(const Words& words, std::ostream& out, std::ostream& err,
                const Terminal& terminal) {
  try {
    const int code = dispatch(words, out, terminal);
    out.flush();
    if (!out) {
      print_line(err, "kolsky: the output could not be written; is the disk full?");
      return kUnexpected;
    }
    return code;
  } catch (const InputError& error) {
    out.flush();
    print_line(err, error.what());
    return kRefused;
  } catch (const std::exception& error) {
    out.flush();
    print_line(err, std::string("kolsky: unexpected: ") + error.what());
    return kUnexpected;
  }
}

}  // namespace kolsky::cli
