#include <algorithm>
#include <cerrno>
#include <string_view>
#include <utility>

#include "drivers/simulated/number_text.hpp"
#include "drivers/simulated/simulated_adc.hpp"

namespace kolsky {

namespace {

constexpr const char* kDeviceId = "iio:device0";
constexpr const char* kDeviceName = "kolsky-adc";
constexpr const char* kCounterId = "count0";

// ADI's DMA cores show their state here: bit 2 is the receive overflow, cleared by writing 1 to it.
constexpr std::uint32_t kStatusRegister = 0x80000088;
constexpr std::uint32_t kOverflowBit = 4;

AttributeReply text(std::string value) {
  return {0, std::move(value)};
}

AttributeReply failure(int error) {
  return {error, {}};
}

std::optional<std::size_t> voltage_index(const std::string& id, std::size_t channels) {
  constexpr std::string_view kPrefix = "voltage";
  if (!id.starts_with(kPrefix)) {
    return std::nullopt;
  }
  const auto index = parse_number<std::size_t>(std::string_view(id).substr(kPrefix.size()));
  return index && *index < channels ? index : std::nullopt;
}

/// strtoul's idea of a number, as the kernel reads registers: 0x... or decimal.
std::optional<std::uint32_t> register_number(std::string_view word) {
  const bool hexadecimal = word.starts_with("0x") || word.starts_with("0X");
  if (hexadecimal) {
    word.remove_prefix(2);
  }
  std::uint32_t value = 0;
  const auto [end, error] =
      std::from_chars(word.data(), word.data() + word.size(), value, hexadecimal ? 16 : 10);
  if (word.empty() || error != std::errc{} || end != word.data() + word.size()) {
    return std::nullopt;
  }
  return value;
}

}  // namespace

bool SimulatedAdc::is_device(const std::string& id) const {
  return id == kDeviceId || id == kDeviceName;
}

AttributeReply SimulatedAdc::read_attribute(const IiodCommand& command,
                                            std::uint32_t register_address) {
  const std::lock_guard lock(mutex_);
  switch (command.scope) {
    case AttributeScope::device:
      return read_device_attribute(command.attribute);
    case AttributeScope::input_channel:
      return read_channel_attribute(command.channel, command.attribute);
    case AttributeScope::debug:
      if (command.attribute == "direct_reg_access") {
        note_overrun();
        return text(register_address == kStatusRegister && status_register_ != 0 ? "0x4" : "0x0");
      }
      return failure(-ENOENT);
    case AttributeScope::buffer:
    case AttributeScope::output_channel:
      break;
  }
  return failure(-ENOENT);
}

void SimulatedAdc::raise_overflow() noexcept {
  status_register_ |= kOverflowBit;
}

void SimulatedAdc::note_overrun() {
  if (stream_ != nullptr && settings_.speed > 0.0 &&
      stream_->buffers_.overrun(clock_.now(), stream_->block_samples_)) {
    raise_overflow();
  }
}

AttributeReply SimulatedAdc::read_device_attribute(const std::string& name) {
  if (name == "sampling_frequency") {
    return text(number_text(settings_.rate.Hz()));
  }
  if (name == "sampling_frequency_available") {
    std::string rates;
    for (const SampleRate& rate : settings_.rates) {
      if (!rates.empty()) {
        rates += ' ';
      }
      rates += number_text(rate.Hz());
    }
    return text(rates);
  }
  if (name == "fire") {
    return text("0");
  }
  if (name == "shots_fired") {
    fire_due_shots(clock_.now());
    return text(std::to_string(shots_fired_));
  }
  if (name == "scenario") {
    return text(settings_.scenario);
  }
  if (name == "seed") {
    return text(std::to_string(settings_.seed));
  }
  if (name == "speed") {
    return text(number_text(settings_.speed));
  }
  if (name == "injected_lost_samples") {
    return text(std::to_string(injected_lost_samples_));
  }
  if (name == "overrun_lost_samples") {
    return text(std::to_string(overrun_lost_samples_));
  }
  return failure(-ENOENT);
}

AttributeReply SimulatedAdc::read_channel_attribute(const std::string& id,
                                                    const std::string& name) {
  if (settings_.counter && id == kCounterId) {
    return name == "raw" ? text(std::to_string(static_cast<std::uint32_t>(clock_.now())))
                         : failure(-ENOENT);
  }
  const auto index = voltage_index(id, settings_.channels.size());
  if (!index) {
    return failure(-ENXIO);
  }
  const AdcChannel& channel = settings_.channels[*index];
  if (name == "raw") {
    std::int32_t code = 0;
    source_->convert(*index, clock_.now(), {&code, 1});
    return text(std::to_string(code));
  }
  if (name == "scale") {
    return text(number_text(channel.scale_mV));
  }
  if (name == "offset") {
    return text(number_text(channel.offset_codes));
  }
  if (name == "strain_scale") {
    return channel.strain_scale ? text(number_text(*channel.strain_scale)) : failure(-ENOENT);
  }
  if (name == "label") {
    return text(channel.label);
  }
  return failure(-ENOENT);
}

int SimulatedAdc::write_attribute(const IiodCommand& command, const std::string& value,
                                  std::uint32_t& register_address) {
  const std::lock_guard lock(mutex_);
  const std::string trimmed(value.begin(), std::find_if(value.begin(), value.end(), [](char c) {
                              return c == '\0' || c == '\n' || c == '\r';
                            }));
  switch (command.scope) {
    case AttributeScope::device:
      return write_device_attribute(command.attribute, trimmed);
    case AttributeScope::debug:
      return command.attribute == "direct_reg_access" ? write_register(trimmed, register_address)
                                                      : -ENOENT;
    case AttributeScope::input_channel: {
      const int error = read_channel_attribute(command.channel, command.attribute).error;
      return error != 0 ? error : -EACCES;
    }
    case AttributeScope::buffer:
    case AttributeScope::output_channel:
      break;
  }
  return -ENOENT;
}

int SimulatedAdc::write_device_attribute(const std::string& name, const std::string& value) {
  if (name == "fire") {
    return value == "1" ? fire_now() : -EINVAL;
  }
  if (name == "sampling_frequency") {
    return set_rate(value);
  }
  const int error = read_device_attribute(name).error;
  return error != 0 ? error : -EACCES;
}

/// "ADDRESS" chooses what the next read shows, "ADDRESS VALUE" writes.
int SimulatedAdc::write_register(const std::string& value, std::uint32_t& register_address) {
  const std::size_t space = value.find(' ');
  const auto address = register_number(std::string_view(value).substr(0, space));
  if (!address) {
    return -EINVAL;
  }
  register_address = *address;
  if (space == std::string::npos) {
    return 0;
  }
  const auto bits = register_number(std::string_view(value).substr(space + 1));
  if (!bits) {
    return -EINVAL;
  }
  if (*address == kStatusRegister) {
    note_overrun();
    status_register_ &= ~*bits;
  }
  return 0;
}

}  // namespace kolsky
