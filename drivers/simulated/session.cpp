#include "drivers/simulated/session.hpp"

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <string>

namespace kolsky {

namespace {

constexpr std::size_t kLongestValue = 4096;
constexpr std::size_t kSendBytes = std::size_t{1} << 16;

constexpr const char* kHelp =
    "PRINT | VERSION | TIMEOUT <ms> | READ/WRITE <device> [INPUT|OUTPUT <channel> | DEBUG | "
    "BUFFER] "
    "<attribute> [<bytes>] | OPEN <device> <samples> <mask> [CYCLIC] | READBUF <device> <bytes> | "
    "CLOSE <device> | SET <device> BUFFERS_COUNT <n> | GETTRIG <device> | SETTRIG <device> "
    "[<trigger>] "
    "| EXIT\n";

std::string mask_line(const std::vector<std::uint32_t>& mask) {
  std::string line;
  for (auto word = mask.rbegin(); word != mask.rend(); ++word) {
    char digits[9];
    std::snprintf(digits, sizeof digits, "%08x", *word);
    line += digits;
  }
  return line + "\n";
}

}  // namespace

Session::Session(Connection& connection, SimulatedAdc& adc) : connection_(connection), adc_(adc) {}

void Session::run() {
  while (const auto line = connection_.read_line()) {
    if (line->empty()) {
      continue;  // libiio ends a session with one
    }
    const ParsedLine parsed = parse_iiod_line(*line);
    if (parsed.error == 0 && parsed.command.verb == IiodVerb::exit) {
      return;
    }
    const bool goes_on = parsed.error != 0 ? reply(parsed.error) : answer(parsed.command);
    if (!goes_on) {
      return;
    }
  }
}

bool Session::answer(const IiodCommand& command) {
  if (!command.device.empty() && !adc_.is_device(command.device)) {
    // The bytes that follow a WRITE are not commands.
    std::string unused;
    if (command.verb == IiodVerb::write &&
        (command.number > kLongestValue || !connection_.read_bytes(command.number, unused))) {
      return false;
    }
    return reply(-ENODEV);
  }
  switch (command.verb) {
    case IiodVerb::help:
      return connection_.write(kHelp);
    case IiodVerb::exit:
      return false;
    case IiodVerb::print:
      return reply_text(adc_.context_xml(), false);
    case IiodVerb::version:
      return connection_.write("0.24.v0.24  \n");
    case IiodVerb::timeout:
      adc_.set_timeout(std::chrono::milliseconds(command.number));
      return reply(0);
    case IiodVerb::open:
      return open(command);
    case IiodVerb::close:
      return close(command);
    case IiodVerb::read:
      return read_attribute(command);
    case IiodVerb::write:
      return write_attribute(command);
    case IiodVerb::read_buffer:
      return read_buffer(command);
    case IiodVerb::get_trigger:
      return reply(0);
    case IiodVerb::set_trigger:
      return reply(command.attribute.empty() ? 0 : -ENOENT);
    case IiodVerb::set_buffers_count:
      return reply(adc_.set_buffers_count(command.number));
  }
  return reply(-EINVAL);
}

bool Session::reply(long code) {
  return connection_.write(std::to_string(code) + "\n");
}

/// Attribute values count and carry their terminating NUL, as libiio's own server sends them.
bool Session::reply_text(const std::string& text, bool terminated) {
  std::string payload = text;
  if (terminated) {
    payload.push_back('\0');
  }
  return connection_.write(std::to_string(payload.size()) + "\n" + payload + "\n");
}

bool Session::read_attribute(const IiodCommand& command) {
  const AttributeReply attribute = adc_.read_attribute(command, register_address_);
  return attribute.error != 0 ? reply(attribute.error) : reply_text(attribute.text, true);
}

bool Session::write_attribute(const IiodCommand& command) {
  std::string value;
  if (command.number > kLongestValue) {
    (void)reply(-EINVAL);
    return false;  // what follows cannot be told from commands
  }
  if (!connection_.read_bytes(command.number, value)) {
    return false;
  }
  const int error = adc_.write_attribute(command, value, register_address_);
  return reply(error != 0 ? error : static_cast<long>(command.number));
}

bool Session::open(const IiodCommand& command) {
  if (stream_) {
    return reply(-EBUSY);
  }
  if (command.cyclic) {
    return reply(-EPERM);  // cyclic buffers are for outputs
  }
  return reply(adc_.open_stream(command.mask, command.number, stream_));
}

bool Session::close(const IiodCommand&) {
  if (!stream_) {
    return reply(-ENXIO);
  }
  stream_.reset();
  return reply(0);
}

bool Session::read_buffer(const IiodCommand& command) {
  if (!stream_) {
    return reply(-EBADF);
  }
  std::size_t wanted = command.number / stream_->scan_bytes();
  const bool whole = wanted > 0 && command.number % stream_->scan_bytes() == 0;
  for (bool first = true; wanted > 0; first = false) {
    switch (await_block()) {
      case Awaited::block:
        break;
      case Awaited::timeout:
        return reply(-ETIMEDOUT);
      case Awaited::over:
        return false;
    }
    const std::size_t samples = std::min(wanted, stream_->available());
    if (!send_samples(samples, first)) {
      return false;
    }
    wanted -= samples;
  }
  return whole || reply(0);
}

Session::Awaited Session::await_block() {
  const auto deadline = adc_.read_deadline();
  for (;;) {
    const auto due = stream_->due();
    if (stream_->available() > 0) {
      return Awaited::block;
    }
    if (!connection_.wait_until(std::min(due, deadline))) {
      return Awaited::over;
    }
    if (due > deadline) {
      return Awaited::timeout;
    }
  }
}

bool Session::send_samples(std::size_t samples, bool with_mask) {
  const std::size_t scan_bytes = stream_->scan_bytes();
  std::string head = std::to_string(samples * scan_bytes) + "\n";
  if (with_mask) {
    head += mask_line(stream_->mask());
  }
  if (!connection_.write(head)) {
    return false;
  }
  const std::size_t most = std::max<std::size_t>(kSendBytes / scan_bytes, 1);
  while (samples > 0) {
    const std::size_t count = std::min(samples, most);
    scans_.resize(count * scan_bytes);
    stream_->read(scans_);
    if (!connection_.write(std::span<const std::byte>(scans_))) {
      return false;
    }
    samples -= count;
  }
  return true;
}

}  // namespace kolsky
