#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace kolsky {

enum class IiodVerb {
  help,
  exit,
  print,
  version,
  timeout,
  open,
  close,
  read,
  write,
  read_buffer,
  get_trigger,
  set_trigger,
  set_buffers_count,
};

/// Which of a device's attributes READ and WRITE mean.
enum class AttributeScope { device, debug, buffer, input_channel, output_channel };

/// One line of IIOD's text protocol, taken apart. What a verb does not use keeps its default.
struct IiodCommand {
  IiodVerb verb = IiodVerb::help;
  std::string device;
  AttributeScope scope = AttributeScope::device;
  std::string channel;
  std::string attribute;
  std::uint64_t number = 0;  ///< TIMEOUT: ms; OPEN: samples; READBUF, WRITE: bytes; SET: buffers
  std::vector<std::uint32_t> mask;  ///< OPEN: word 0 holds channels 0 to 31
  bool cyclic = false;
};

/// What parsing a line came to: a command, or the negative errno that answers the line.
struct ParsedLine {
  int error = 0;  ///< 0, or -EINVAL
  IiodCommand command;
};

/// Parses one line without its line end. Total: any bytes give a command or an error.
/// Numbers are decimal and below 2^31; a mask is 8 hexadecimal digits a word, at most 8 words.
[[nodiscard]] ParsedLine parse_iiod_line(std::string_view line);

}  // namespace kolsky
