#include "drivers/simulated/simulated_adc.hpp"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <utility>

#include "drivers/simulated/number_text.hpp"
#include "processing/base/error.hpp"

namespace kolsky {

namespace {

constexpr const char* kDeviceId = "iio:device0";
constexpr const char* kDeviceName = "kolsky-adc";
constexpr const char* kCounterId = "count0";
constexpr std::uint64_t kMostBuffers = 1024;
constexpr std::uint64_t kMostBlockSamples = std::uint64_t{1} << 28;

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

void check(const AdcSettings& settings) {
  if (settings.bits < 12 || settings.bits > 24) {
    throw InputError("bits", std::to_string(settings.bits) + " is not a simulated resolution",
                     "give 12 to 24");
  }
  if (settings.channels.empty() || settings.channels.size() > 128) {
    throw InputError("channels",
                     "a converter with " + std::to_string(settings.channels.size()) + " channels",
                     "give 1 to 128");
  }
  if (!(settings.speed >= 0.0) || !std::isfinite(settings.speed)) {
    throw InputError("speed", number_text(settings.speed) + " is not a speed",
                     "give a factor on real time, or 0 for as fast as the client reads");
  }
  if (!(settings.period_s >= 0.0) || !std::isfinite(settings.period_s)) {
    throw InputError("period", number_text(settings.period_s) + " s is not a period",
                     "give seconds between shots, or 0 for shots on demand");
  }
  if (std::find(settings.rates.begin(), settings.rates.end(), settings.rate) ==
      settings.rates.end()) {
    throw InputError("sampling frequency",
                     number_text(settings.rate.Hz()) + " Hz is not among the rates",
                     "give one of them");
  }
}

}  // namespace

SimulatedAdc::SimulatedAdc(AdcSettings settings, std::unique_ptr<CodeSource> source)
    : settings_(std::move(settings)), source_(std::move(source)) {
  check(settings_);
  source_->set_rate(settings_.rate);
  if (settings_.period_s > 0.0 && period_ticks() < source_->shot_samples()) {
    throw InputError(
        "period", number_text(settings_.period_s) + " s is shorter than a shot",
        "give at least " +
            number_text(static_cast<double>(source_->shot_samples()) * settings_.rate.period_s()) +
            " s");
  }
  next_periodic_shot_ = period_ticks();
  restart_clock(0);
}

std::size_t SimulatedAdc::scan_elements() const noexcept {
  return settings_.channels.size() + (settings_.counter ? 1 : 0);
}

double SimulatedAdc::ticks_per_s() const noexcept {
  return settings_.rate.Hz() * settings_.speed;
}

void SimulatedAdc::restart_clock(Tick at) {
  clock_start_ = Clock::now();
  clock_start_tick_ = at;
}

Tick SimulatedAdc::now_tick() const {
  if (settings_.speed == 0.0) {
    return planned_until_;
  }
  const std::chrono::duration<double> passed = Clock::now() - clock_start_;
  return clock_start_tick_ + static_cast<Tick>(passed.count() * ticks_per_s());
}

SimulatedAdc::Clock::time_point SimulatedAdc::time_of(Tick tick) const {
  if (settings_.speed == 0.0) {
    return Clock::time_point::min();
  }
  const std::chrono::duration<double> after(static_cast<double>(tick - clock_start_tick_) /
                                            ticks_per_s());
  return clock_start_ + std::chrono::ceil<Clock::duration>(after);
}

Tick SimulatedAdc::period_ticks() const {
  return static_cast<Tick>(std::llround(settings_.period_s * settings_.rate.Hz()));
}

void SimulatedAdc::fire_due_shots(Tick until) {
  if (settings_.period_s == 0.0) {
    return;
  }
  for (; next_periodic_shot_ < until; next_periodic_shot_ += period_ticks()) {
    if (next_periodic_shot_ >= shot_ends_) {
      start_shot(next_periodic_shot_);
    }
  }
}

void SimulatedAdc::start_shot(Tick tick) {
  source_->fire(tick);
  shot_ends_ = tick + source_->shot_samples();
  ++shots_fired_;
}

int SimulatedAdc::fire_now() {
  const Tick tick = std::max(now_tick(), planned_until_);
  fire_due_shots(tick + 1);
  if (tick < shot_ends_) {
    return -EBUSY;
  }
  start_shot(tick);
  return 0;
}

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

void SimulatedAdc::note_overrun() {
  if (stream_ != nullptr && settings_.speed > 0.0 &&
      stream_->buffers_.overrun(now_tick(), stream_->block_samples_)) {
    status_register_ |= kOverflowBit;
  }
}

void SimulatedAdc::note_lost(Tick samples) {
  if (samples > 0) {
    status_register_ |= kOverflowBit;
    overrun_lost_samples_ += static_cast<std::uint64_t>(samples);
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
    fire_due_shots(now_tick());
    return text(std::to_string(shots_fired_));
  }
  if (name == "scenario") {
    return text(settings_.scenario);
  }
  if (name == "seed") {
    return text(std::to_string(settings_.seed));
  }
  if (name == "overrun_lost_samples") {
    return text(std::to_string(overrun_lost_samples_));
  }
  return failure(-ENOENT);
}

AttributeReply SimulatedAdc::read_channel_attribute(const std::string& id,
                                                    const std::string& name) {
  if (settings_.counter && id == kCounterId) {
    return name == "raw" ? text(std::to_string(static_cast<std::uint32_t>(now_tick())))
                         : failure(-ENOENT);
  }
  const auto index = voltage_index(id, settings_.channels.size());
  if (!index) {
    return failure(-ENXIO);
  }
  const AdcChannel& channel = settings_.channels[*index];
  if (name == "raw") {
    std::int32_t code = 0;
    source_->convert(*index, now_tick(), {&code, 1});
    return text(std::to_string(code));
  }
  if (name == "scale") {
    return text(number_text(channel.scale_mV));
  }
  if (name == "offset") {
    return text(number_text(channel.offset_codes));
  }
  if (name == "strain_scale") {
    return text(number_text(channel.strain_scale));
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

int SimulatedAdc::set_rate(const std::string& value) {
  const auto asked_Hz = parse_number<double>(value);
  if (!asked_Hz) {
    return -EINVAL;
  }
  const auto rate =
      std::find(settings_.rates.begin(), settings_.rates.end(), SampleRate::from_Hz(*asked_Hz));
  if (rate == settings_.rates.end()) {
    return -EINVAL;
  }
  if (*rate == settings_.rate) {
    return 0;
  }
  const Tick now = std::max(now_tick(), planned_until_);
  if (stream_ != nullptr || now < shot_ends_) {
    return -EBUSY;
  }
  settings_.rate = *rate;
  source_->set_rate(*rate);
  restart_clock(now);
  next_periodic_shot_ = now + period_ticks();
  return 0;
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

int SimulatedAdc::set_buffers_count(std::uint64_t count) {
  const std::lock_guard lock(mutex_);
  if (count == 0 || count > kMostBuffers) {
    return -EINVAL;
  }
  if (stream_ != nullptr) {
    return -EBUSY;
  }
  buffers_count_ = static_cast<int>(count);
  return 0;
}

void SimulatedAdc::set_timeout(std::chrono::milliseconds timeout) {
  const std::lock_guard lock(mutex_);
  timeout_ = timeout;
}

SimulatedAdc::Clock::time_point SimulatedAdc::read_deadline() {
  const std::lock_guard lock(mutex_);
  return timeout_.count() == 0 ? Clock::time_point::max() : Clock::now() + timeout_;
}

int SimulatedAdc::open_stream(const std::vector<std::uint32_t>& mask, std::uint64_t block_samples,
                              std::unique_ptr<AdcStream>& stream) {
  const std::lock_guard lock(mutex_);
  const std::size_t words = (scan_elements() + 31) / 32;
  if (mask.size() != words || block_samples == 0) {
    return -EINVAL;
  }
  const std::size_t spare_bits = words * 32 - scan_elements();
  const bool unknown_channel = spare_bits > 0 && (mask.back() >> (32 - spare_bits)) != 0;
  const bool none = std::all_of(mask.begin(), mask.end(), [](std::uint32_t w) { return w == 0; });
  if (unknown_channel || none) {
    return -EINVAL;
  }
  if (block_samples > kMostBlockSamples) {
    return -ENOMEM;
  }
  if (stream_ != nullptr) {
    return -EBUSY;
  }
  stream = std::make_unique<AdcStream>(*this, mask, static_cast<Tick>(block_samples));
  stream_ = stream.get();
  return 0;
}

}  // namespace kolsky
