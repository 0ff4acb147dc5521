#include "drivers/simulated/session.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <span>
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

}  // namespace

Session::Session(Connection& connection, SimulatedAdc& adc, Drop drop)
    : connection_(connection), adc_(adc), drop_(std::move(drop)) {}

void Session::run() {
  while (const auto line = connection_.read_line()) {
    if (line->empty()) {
      continue;  // libiio ends a session with one
    }
    if (const auto silence = adc_.silent_until();
        silence > SimulatedAdc::Clock::now() && !connection_.wait_until(silence)) {
      return;
    }
    const ParsedLine parsed = parse_iiod_line(*line);
    if (!(parsed.error != 0 ? reply(parsed.error) : answer(parsed.command))) {
      return;
    }
  }
}

bool Session::refuse_unknown_device(const IiodCommand& command) {
  // The bytes that follow a WRITE are not commands.
  std::string unused;
  if (command.verb == IiodVerb::write &&
      (command.number > kLongestValue || !connection_.read_bytes(command.number, unused))) {
    return false;
  }
  return reply(-ENODEV);
}

bool Session::answer(const IiodCommand& command) {
  if (!command.device.empty() && !adc_.is_device(command.device)) {
    return refuse_unknown_device(command);
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
      return close();
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

bool Session::close() {
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
  Reply answered;
  answered.bytes_left = command.number;
  answered.most_samples = command.number;
  const bool goes_on = send_blocks(answered);
  stream_->end_reply();
  return goes_on;
}

/// Sends blocks until the client has the bytes it asked for. A fault or a time-out after the first
/// of them ends the reply early and meets the next read: a client throws away what came before an
/// error.
bool Session::send_blocks(Reply& answered) {
  while (answered.bytes_left >= stream_->layout().bytes() && answered.most_samples > 0) {
    Next next = await_block();
    if (next == Next::go_on && stream_->fault_pending()) {
      if (answered.started) {
        break;
      }
      next = act(*stream_->take_fault(), answered);
      if (next == Next::go_on) {
        continue;
      }
    }
    if (next == Next::leave) {
      return false;
    }
    if (next == Next::refuse) {
      return reply(answered.started ? 0 : -ETIMEDOUT);
    }
    const std::size_t scan_bytes = stream_->layout().bytes();
    const std::size_t samples =
        std::min({answered.bytes_left / scan_bytes, stream_->available(), answered.most_samples});
    if (!send_samples(samples, !answered.started)) {
      return false;
    }
    answered.started = true;
    answered.bytes_left -= samples * scan_bytes;
    answered.most_samples -= samples;
  }
  return (answered.bytes_left == 0 && answered.started) || reply(0);
}

Session::Next Session::await_block() {
  const auto deadline = adc_.read_deadline();
  for (;;) {
    const auto now = SimulatedAdc::Clock::now();
    const auto due = stream_->due(now);
    if (due <= now) {
      return Next::go_on;
    }
    if (deadline <= now) {
      return Next::refuse;
    }
    if (!connection_.wait_until(std::min(due, deadline))) {
      return Next::leave;
    }
  }
}

Session::Next Session::act(const Fault& fault, Reply& answered) {
  switch (fault.kind) {
    case FaultKind::short_block:
      answered.most_samples =
          std::min(answered.most_samples, static_cast<std::size_t>(fault.samples));
      return Next::go_on;
    case FaultKind::late_block:
      return pause(fault.duration_s);
    case FaultKind::timeout:
      return Next::refuse;
    case FaultKind::hang:
      adc_.keep_silent(fault.duration_s);
      if (fault.duration_s == 0.0) {
        (void)connection_.wait_until(SimulatedAdc::Clock::time_point::max());
        return Next::leave;
      }
      return pause(fault.duration_s);
    case FaultKind::drop:
      drop_(fault.duration_s);
      adc_.paused(fault.duration_s);
      return Next::leave;
    case FaultKind::extra_channel:
      stream_->add_channel();
      return Next::go_on;
    case FaultKind::lose:
    case FaultKind::overflow:
    case FaultKind::clip:
      break;  // the stream itself has seen to these
  }
  return Next::go_on;
}

Session::Next Session::pause(double seconds) {
  if (!connection_.wait_until(adc_.pause_end(seconds))) {
    return Next::leave;
  }
  adc_.paused(seconds);
  return Next::go_on;
}

/// The head travels with the first samples: one packet less for every block.
bool Session::send_samples(std::size_t samples, bool with_mask) {
  const std::size_t scan_bytes = stream_->layout().bytes();
  std::string head = std::to_string(samples * scan_bytes) + "\n";
  if (with_mask) {
    head += stream_->layout().mask_text() + "\n";
  }
  const std::size_t most = std::max<std::size_t>(kSendBytes / scan_bytes, 1);
  while (samples > 0) {
    const std::size_t count = std::min(samples, most);
    outgoing_.resize(head.size() + count * scan_bytes);
    std::memcpy(outgoing_.data(), head.data(), head.size());
    stream_->read(std::span(outgoing_).subspan(head.size()));
    if (!connection_.write(std::span<const std::byte>(outgoing_))) {
      return false;
    }
    head.clear();
    samples -= count;
  }
  return true;
}

}  // namespace kolsky
