#include "drivers/simulated/iiod_command.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <optional>

namespace kolsky {

namespace {

constexpr std::size_t kMaskDigits = 8;
constexpr std::size_t kMostMaskWords = 8;
constexpr std::uint64_t kNumberLimit = std::uint64_t{1} << 31;

using Words = std::vector<std::string_view>;

Words split(std::string_view line) {
  Words words;
  while (!line.empty()) {
    const std::size_t start = line.find_first_not_of(" \t");
    if (start == std::string_view::npos) {
      break;
    }
    const std::size_t end = std::min(line.find_first_of(" \t", start), line.size());
    words.push_back(line.substr(start, end - start));
    line.remove_prefix(end);
  }
  return words;
}

std::optional<std::uint64_t> number(std::string_view word) {
  std::uint64_t value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc{} || end != word.data() + word.size() || value >= kNumberLimit) {
    return std::nullopt;
  }
  return value;
}

/// The first word on the wire holds the highest channels.
std::optional<std::vector<std::uint32_t>> mask_words(std::string_view digits) {
  if (digits.empty() || digits.size() % kMaskDigits != 0 ||
      digits.size() > kMaskDigits * kMostMaskWords) {
    return std::nullopt;
  }
  std::vector<std::uint32_t> words;
  for (std::size_t at = digits.size(); at > 0; at -= kMaskDigits) {
    const char* first = digits.data() + at - kMaskDigits;
    std::uint32_t word = 0;
    const auto [end, error] = std::from_chars(first, first + kMaskDigits, word, 16);
    if (error != std::errc{} || end != first + kMaskDigits) {
      return std::nullopt;
    }
    words.push_back(word);
  }
  return words;
}

using Parsed = std::optional<IiodCommand>;

Parsed bare(IiodVerb verb, const Words& words) {
  if (words.size() != 1) {
    return std::nullopt;
  }
  IiodCommand command;
  command.verb = verb;
  return command;
}

Parsed timeout(const Words& words) {
  const auto milliseconds = words.size() == 2 ? number(words[1]) : std::nullopt;
  if (!milliseconds) {
    return std::nullopt;
  }
  IiodCommand command;
  command.verb = IiodVerb::timeout;
  command.number = *milliseconds;
  return command;
}

Parsed open(const Words& words) {
  if (words.size() < 4 || words.size() > 5 || (words.size() == 5 && words[4] != "CYCLIC")) {
    return std::nullopt;
  }
  const auto samples = number(words[2]);
  auto mask = mask_words(words[3]);
  if (!samples || !mask) {
    return std::nullopt;
  }
  IiodCommand command;
  command.verb = IiodVerb::open;
  command.device = words[1];
  command.number = *samples;
  command.mask = std::move(*mask);
  command.cyclic = words.size() == 5;
  return command;
}

Parsed of_device(IiodVerb verb, const Words& words) {
  if (words.size() != 2) {
    return std::nullopt;
  }
  IiodCommand command;
  command.verb = verb;
  command.device = words[1];
  return command;
}

Parsed read_buffer(const Words& words) {
  const auto bytes = words.size() == 3 ? number(words[2]) : std::nullopt;
  if (!bytes) {
    return std::nullopt;
  }
  IiodCommand command;
  command.verb = IiodVerb::read_buffer;
  command.device = words[1];
  command.number = *bytes;
  return command;
}

Parsed set_trigger(const Words& words) {
  if (words.size() != 2 && words.size() != 3) {
    return std::nullopt;
  }
  IiodCommand command;
  command.verb = IiodVerb::set_trigger;
  command.device = words[1];
  command.attribute = words.size() == 3 ? words[2] : std::string_view{};
  return command;
}

Parsed set_buffers_count(const Words& words) {
  const auto count =
      words.size() == 4 && words[2] == "BUFFERS_COUNT" ? number(words[3]) : std::nullopt;
  if (!count) {
    return std::nullopt;
  }
  IiodCommand command;
  command.verb = IiodVerb::set_buffers_count;
  command.device = words[1];
  command.number = *count;
  return command;
}

/// `<dev> [INPUT|OUTPUT <channel> | DEBUG | BUFFER] <attribute>`, as READ and WRITE have it.
Parsed attribute_of(IiodVerb verb, Words words) {
  if (words.size() < 3) {
    return std::nullopt;
  }
  IiodCommand command;
  command.verb = verb;
  command.device = words[1];
  words.erase(words.begin(), words.begin() + 2);
  if (words.size() == 3 && (words[0] == "INPUT" || words[0] == "OUTPUT")) {
    command.scope =
        words[0] == "INPUT" ? AttributeScope::input_channel : AttributeScope::output_channel;
    command.channel = words[1];
  } else if (words.size() == 2 && (words[0] == "DEBUG" || words[0] == "BUFFER")) {
    command.scope = words[0] == "DEBUG" ? AttributeScope::debug : AttributeScope::buffer;
  } else if (words.size() != 1) {
    return std::nullopt;
  }
  command.attribute = words.back();
  return command;
}

Parsed write(Words words) {
  const auto bytes = words.size() >= 4 ? number(words.back()) : std::nullopt;
  if (!bytes) {
    return std::nullopt;
  }
  words.pop_back();
  Parsed command = attribute_of(IiodVerb::write, std::move(words));
  if (command) {
    command->number = *bytes;
  }
  return command;
}

Parsed parse(const Words& words) {
  const std::string_view verb = words.front();
  if (verb == "READBUF") return read_buffer(words);
  if (verb == "READ") return attribute_of(IiodVerb::read, words);
  if (verb == "WRITE") return write(words);
  if (verb == "OPEN") return open(words);
  if (verb == "CLOSE") return of_device(IiodVerb::close, words);
  if (verb == "PRINT") return bare(IiodVerb::print, words);
  if (verb == "VERSION") return bare(IiodVerb::version, words);
  if (verb == "TIMEOUT") return timeout(words);
  if (verb == "GETTRIG") return of_device(IiodVerb::get_trigger, words);
  if (verb == "SETTRIG") return set_trigger(words);
  if (verb == "SET") return set_buffers_count(words);
  if (verb == "HELP") return bare(IiodVerb::help, words);
  if (verb == "EXIT") return bare(IiodVerb::exit, words);
  return std::nullopt;
}

}  // namespace

ParsedLine parse_iiod_line(std::string_view line) {
  const Words words = split(line);
  if (words.empty()) {
    return {-EINVAL, {}};
  }
  Parsed command = parse(words);
  if (!command) {
    return {-EINVAL, {}};
  }
  return {0, std::move(*command)};
}

}  // namespace kolsky
