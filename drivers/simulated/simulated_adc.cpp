#include "drivers/simulated/simulated_adc.hpp"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <limits>
#include <utility>

#include "drivers/simulated/number_text.hpp"
#include "processing/base/error.hpp"

namespace kolsky {

namespace {

constexpr std::uint64_t kMostBuffers = 1024;
constexpr std::uint64_t kMostBlockSamples = std::uint64_t{1} << 28;

}  // namespace

void check(const AdcSettings& settings) {
  if (settings.bits < 12 || settings.bits > 32) {
    throw InputError("bits", std::to_string(settings.bits) + " is not a simulated resolution",
                     "give 12 to 32");
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

SimulatedAdc::SimulatedAdc(AdcSettings settings, std::unique_ptr<CodeSource> source)
    : settings_(std::move(settings)),
      source_(std::move(source)),
      clock_((check(settings_), settings_.rate), settings_.speed),
      faults_(settings_.faults, settings_.rate) {
  source_->set_rate(settings_.rate);
  if (settings_.period_s > 0.0 && period_ticks() < source_->shot_samples()) {
    const double shot_s = static_cast<double>(source_->shot_samples()) * settings_.rate.period_s();
    throw InputError("period", number_text(settings_.period_s) + " s is shorter than a shot",
                     "give at least " + number_text(shot_s) + " s");
  }
  next_periodic_shot_ = period_ticks();
}

std::vector<std::size_t> SimulatedAdc::element_bytes() const {
  std::vector<std::size_t> bytes(settings_.channels.size(), settings_.bits <= 16 ? 2 : 4);
  if (settings_.counter) {
    bytes.push_back(sizeof(std::uint32_t));
  }
  return bytes;
}

std::int32_t SimulatedAdc::highest_code() const noexcept {
  return static_cast<std::int32_t>((std::int64_t{1} << (settings_.bits - 1)) - 1);
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
  faults_.shot_fired(shots_fired_, tick);
  log("shot " + std::to_string(shots_fired_) + " at sample " + std::to_string(tick));
}

int SimulatedAdc::fire_now() {
  const Tick tick = clock_.next();
  fire_due_shots(tick + 1);
  if (tick < shot_ends_) {
    return -EBUSY;
  }
  start_shot(tick);
  return 0;
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
  if (stream_ != nullptr || clock_.next() < shot_ends_) {
    return -EBUSY;
  }
  settings_.rate = *rate;
  source_->set_rate(*rate);
  clock_.set_rate(*rate);
  next_periodic_shot_ = clock_.next() + period_ticks();
  return 0;
}

void SimulatedAdc::note_fault(const FaultQueue::Due& due) {
  log(std::string("fault: ") + fault_name(due.fault.kind) + " at sample " +
      std::to_string(due.tick));
}

void SimulatedAdc::skip_faults(Tick until) {
  while (const auto passed = faults_.take_before(until)) {
    log(std::string("no fault: ") + fault_name(passed->fault.kind) + " at sample " +
        std::to_string(passed->tick) + ", which nobody read");
  }
}

void SimulatedAdc::log(const std::string& text) const {
  if (settings_.log) {
    settings_.log(text);
  }
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

SimulatedAdc::Clock::time_point SimulatedAdc::silent_until() {
  const std::lock_guard lock(mutex_);
  return silent_until_;
}

void SimulatedAdc::keep_silent(double seconds) {
  const std::lock_guard lock(mutex_);
  silent_until_ = seconds == 0.0 ? Clock::time_point::max() : Clock::now() + clock_.pause(seconds);
}

SimulatedAdc::Clock::time_point SimulatedAdc::pause_end(double seconds) {
  const std::lock_guard lock(mutex_);
  return Clock::now() + clock_.pause(seconds);
}

void SimulatedAdc::paused(double seconds) {
  const std::lock_guard lock(mutex_);
  clock_.paused(seconds);
}

int SimulatedAdc::open_stream(const std::vector<std::uint32_t>& mask, std::uint64_t block_samples,
                              std::unique_ptr<AdcStream>& stream) {
  const std::lock_guard lock(mutex_);
  const std::size_t elements = element_bytes().size();
  const std::size_t words = (elements + 31) / 32;
  if (mask.size() != words || block_samples == 0) {
    return -EINVAL;
  }
  const std::size_t spare_bits = words * 32 - elements;
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
  skip_faults(stream->read_until_);
  if (fault_gap_from_) {
    injected_lost_samples_ += stream->read_until_ - *fault_gap_from_;
    fault_gap_from_.reset();
  }
  return 0;
}

}  // namespace kolsky
