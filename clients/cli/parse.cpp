#include "clients/cli/parse.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <sstream>

#include "drivers/files/settings/nearest_name.hpp"
#include "processing/base/error.hpp"
#include "proto/protocol.hpp"

namespace kolsky::cli {
namespace {

constexpr std::size_t kNameColumns = 28;
constexpr std::size_t kHelpColumns = 100;

std::string place_of(const Command& command) {
  return "kolsky " + command.name;
}

std::string see_help(const Command& command) {
  return "see kolsky " + command.name + " --help";
}

bool is_option(const std::string& name) {
  return name.starts_with("-");
}

// One line, whatever a library's message holds.
std::string one_line(std::string text) {
  std::replace(text.begin(), text.end(), '\n', ' ');
  return text;
}

// CLI11 indents the lines of a help text but does not break them. Those that it has already stay.
std::string broken_into_lines(const std::string& text) {
  std::istringstream given(text);
  std::string lines;
  for (std::string own; std::getline(given, own);) {
    for (const std::string& line : wrapped(own, kHelpColumns - kNameColumns)) {
      lines += (lines.empty() ? "" : "\n") + line;
    }
  }
  return lines;
}

std::string refuse_no_count(const std::string& count) {
  if (count.starts_with("-")) {
    return "a count is not negative";  // it would wrap round
  }
  return count.find_first_not_of("0123456789") != std::string::npos
             ? "\"" + count + "\" is not a whole number"
             : "";
}

CLI::Option* add(CLI::App& app, const Argument& argument) {
  const std::string help = broken_into_lines(argument.help);
  CLI::Option* option = std::visit(
      [&](auto* target) {
        using Value = std::remove_pointer_t<decltype(target)>;
        if constexpr (std::is_same_v<Value, bool>) {
          return app.add_flag(argument.name, *target, help)->disable_flag_override();
        } else {
          CLI::Option* taker = app.add_option(argument.name, *target, help);
          taker->type_name(is_option(argument.name) ? argument.value : "");
          return std::is_same_v<Value, std::optional<std::uint64_t>> ? taker->check(refuse_no_count)
                                                                     : taker;
        }
      },
      argument.target);
  if (!argument.choices.empty()) {
    option->check(CLI::IsMember(argument.choices));
  }
  return option;
}

class CommandLine {
 public:
  explicit CommandLine(const Command& command)
      : command_(command),
        app_("kolsky " + command.name + ": " + command.purpose, "kolsky " + command.name) {
    app_.set_help_flag();
    // What is left over is reported here, with the nearest name, before anything that is missing.
    app_.allow_extras();
    app_.get_formatter()->column_width(kNameColumns);
    app_.footer("Examples:\n" + command.examples);
    for (const Argument& argument : command.arguments) {
      options_.push_back(add(app_, argument));
    }
    app_.add_flag("--json", common_.json, "print one JSON object and nothing else")
        ->disable_flag_override();
    if (command.uses_daemon) {
      common_.endpoint = wire::kDefaultControlEndpoint;
      app_.add_option("--endpoint", common_.endpoint, "control endpoint of kolskyd")
          ->type_name("TCP")
          ->envname("KOLSKY_ENDPOINT")
          ->capture_default_str();
    }
    app_.add_flag("-h,--help", common_.help, "print this and exit");
  }

  [[nodiscard]] std::string help() { return app_.help(); }

  CommonOptions parse(std::vector<std::string> words) {
    if (std::any_of(words.begin(), words.end(),
                    [](const std::string& word) { return word == "--help" || word == "-h"; })) {
      common_.help = true;
      return common_;
    }
    std::reverse(words.begin(), words.end());  // as CLI11 takes them
    try {
      app_.parse(words);
    } catch (const CLI::ParseError& error) {
      throw InputError(place_of(command_), one_line(error.what()), see_help(command_));
    }
    refuse_leftovers();
    refuse_missing();
    refuse_not_finite();
    return common_;
  }

 private:
  void refuse_leftovers() const {
    const std::vector<std::string> left = app_.remaining();
    if (left.empty()) {
      return;
    }
    const std::string& word = left.front();
    if (!is_option(word)) {
      throw InputError(place_of(command_), "\"" + word + "\" is one word too many",
                       see_help(command_));
    }
    std::vector<std::string> names;
    for (const CLI::Option* option : app_.get_options()) {
      for (const std::string& name : option->get_lnames()) {
        names.push_back("--" + name);
      }
    }
    throw InputError(place_of(command_), "there is no option " + word,
                     "the nearest is " + nearest_name(word.substr(0, word.find('=')), names) +
                         "; " + see_help(command_));
  }

  void refuse_missing() const {
    for (std::size_t i = 0; i < options_.size(); ++i) {
      const Argument& argument = command_.arguments[i];
      if (argument.required && options_[i]->count() == 0) {
        throw InputError(place_of(command_), argument.name + " is missing",
                         "give " + argument.help + "; " + see_help(command_));
      }
    }
  }

  void refuse_not_finite() const {
    for (const Argument& argument : command_.arguments) {
      const auto* const* number = std::get_if<std::optional<double>*>(&argument.target);
      if (number != nullptr && (*number)->has_value() && !std::isfinite(***number)) {
        throw InputError(place_of(command_) + ": " + argument.name, "not a finite number",
                         "give a finite number");
      }
    }
  }

  const Command& command_;
  CLI::App app_;
  CommonOptions common_;
  std::vector<CLI::Option*> options_;
};

}  // namespace

CommonOptions parse(const Command& command, const std::vector<std::string>& words) {
  return CommandLine(command).parse(words);
}

std::string help_text(const Command& command) {
  return CommandLine(command).help();
}

}  // namespace kolsky::cli
