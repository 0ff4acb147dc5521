#include "daemon/acquisition/acquirer.hpp"

#include <algorithm>
#include <chrono>
#include <memory>
#include <thread>

#include "daemon/thread_priority.hpp"

namespace kolsky {

namespace {

constexpr std::int64_t kFirstPause_ms = 100;
constexpr std::int64_t kLongestPause_ms = 2000;

template <typename Code>
std::span<const Code> codes_of(std::span<const std::byte> bytes) {
  return {reinterpret_cast<const Code*>(bytes.data()), bytes.size() / sizeof(Code)};
}

bool same_channel(const ChannelInfo& one, const ChannelInfo& other) {
  return one.name == other.name && one.unit == other.unit && one.scale == other.scale &&
         one.offset == other.offset && one.bits == other.bits;
}

}  // namespace

Acquirer::Acquirer(Digitiser& digitiser, SampleRing& ring, AcquisitionQueue& events,
                   const AcquisitionPlan& plan)
    : digitiser_(digitiser),
      ring_(ring),
      stream_(digitiser.info()),
      teller_(events),
      windows_(stream_, ring.capacity_samples(), teller_),
      levels_(stream_.channels.size(), plan.trigger),
      watch_(plan),
      statistics_(stream_.channels.size()) {}

void Acquirer::start() {
  thread_ = Thread("kolsky-acquire", [this] { run(); });
}

void Acquirer::stop() {
  stop_.store(true);
  if (thread_.begun()) {
    digitiser_.cancel();
    thread_.join();
  }
}

void Acquirer::change_plan(const AcquisitionPlan& plan) {
  next_watch_.give(std::make_unique<Watch>(plan));
}

Acquirer::Counters Acquirer::counters() const noexcept {
  return {.samples_read = samples_read_.load(),
          .samples_missing = samples_missing_.load(),
          .gaps_of_unknown_length = unknown_gaps_.load(),
          .overflows = overflows_.load(),
          .reconnects = reconnects_.load(),
          .triggers = windows_.triggers(),
          .windows_refused = windows_.refused(),
          .progress = progress_.load()};
}

void Acquirer::run() {
  go_real_time();
  Block block;
  block.channels.reserve(stream_.channels.size());
  while (!stop_.load(std::memory_order_relaxed)) {
    progress_.fetch_add(1, std::memory_order_relaxed);
    if (next_watch_.take(watch_)) {
      learn_anew();
    }
    stay_polite();
    switch (digitiser_.read(block)) {
      case ReadStatus::samples:
        take(block);
        break;
      case ReadStatus::timeout:
        // It has waited already; if it has not, this keeps the loop from spinning.
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
        break;
      case ReadStatus::overflow:
        overflows_.fetch_add(1, std::memory_order_relaxed);
        overflow_pending_ = true;
        tell(AcquisitionEvent::Kind::overflow);
        break;
      case ReadStatus::disconnected:
        handle_disconnect();
        break;
      case ReadStatus::end_of_capture:
        end_capture();
        tell(AcquisitionEvent::Kind::end_of_capture);
        ended_.store(true);
        return;
    }
  }
  windows_.interrupt();
}

void Acquirer::go_real_time() {
  if (!stream_.ends) {  // a replay ahead of its own consumers would only wait for them
    real_time_.store(run_in_real_time(RealTime::reading));
  }
}

void Acquirer::stay_polite() {
  if (real_time_.load(std::memory_order_relaxed) && !idle_check_.rests()) {
    real_time_.store(!run_as_usual());
  }
}

void Acquirer::learn_anew() {
  watch_.trigger.reset();
  levels_.forget();
}

void Acquirer::take(const Block& block) {
  const Tick block_end = block.first_tick + static_cast<Tick>(block.samples);
  if (block.starts_capture || !streaming_) {
    begin_capture(block);
  }
  note_missing(block);
  windows_.cut_if_too_long(block_end, watch_.plan);
  wait_for_room(block_end);
  ring_.write(block, statistics_);
  windows_.reach(block_end, block.monotonic_ns);
  samples_read_.fetch_add(block.samples, std::memory_order_relaxed);
  watch(block);
  windows_.close_full();
  levels_.follow(statistics_, watch_.plan.trigger_channel, watch_.trigger);
  watching_.store(watch_.trigger.ready(), std::memory_order_release);
}

void Acquirer::note_missing(const Block& block) {
  const Missing& missing = block.missing_before;
  overflow_pending_ = false;  // the block says what the overflow came to
  // Before a capture of a replay nothing is missing but the world between two captures.
  const bool between = block.starts_capture && missing.kind == Missing::Kind::unknown;
  if (missing.kind == Missing::Kind::none || between) {
    return;
  }
  const bool known = missing.kind == Missing::Kind::known;
  AcquisitionEvent event;
  event.kind = AcquisitionEvent::Kind::gap;
  event.tick = block.first_tick;
  event.gap.samples = known ? missing.samples : 0;
  event.gap.first_tick = block.first_tick - event.gap.samples;
  event.gap.known = known;
  samples_missing_.fetch_add(static_cast<std::uint64_t>(event.gap.samples),
                             std::memory_order_relaxed);
  unknown_gaps_.fetch_add(known ? 0 : 1, std::memory_order_relaxed);
  watch_.trigger.reset_run();
  teller_.tell_gap(event);
}

void Acquirer::begin_capture(const Block& block) {
  end_capture();
  const bool headless = block.starts_capture && block.missing_before.kind == Missing::Kind::known;
  streaming_ = true;
  windows_.begin_capture(block.first_tick - (headless ? block.missing_before.samples : 0));
  capture_marked_ = false;
  learn_anew();
}

void Acquirer::end_capture() {
  if (overflow_pending_) {  // samples were lost, and none came after them
    overflow_pending_ = false;
    windows_.interrupt();
  } else {
    windows_.end_capture();
  }
}

void Acquirer::watch(const Block& block) {
  if (block.mark) {
    capture_marked_ = true;
    if (armed()) {
      windows_.take_mark(*block.mark, watch_.plan);
    }
  }
  const std::optional<TriggerEvent> event = feed_trigger(block);
  if (event && armed() && !capture_marked_) {
    windows_.trigger_at(*event, watch_.plan);
  }
  if (force_.load(std::memory_order_relaxed) && force_.exchange(false)) {
    windows_.trigger_at({.tick = block.first_tick, .kind = TriggerKind::forced}, watch_.plan);
  }
}

std::optional<TriggerEvent> Acquirer::feed_trigger(const Block& block) {
  const std::size_t channel = watch_.plan.trigger_channel;
  const std::span<const std::byte> bytes = block.channels[channel];
  const RunStatistics& statistics = statistics_[channel];
  return stream_.format == SampleFormat::int16
             ? watch_.trigger.feed(block.first_tick, codes_of<std::int16_t>(bytes), statistics)
             : watch_.trigger.feed(block.first_tick, codes_of<std::int32_t>(bytes), statistics);
}

void Acquirer::tell(AcquisitionEvent::Kind kind) {
  AcquisitionEvent event;
  event.kind = kind;
  event.tick = windows_.reached();
  teller_.tell(event);
}

void Acquirer::wait_for_room(Tick end_tick) {
  if (!stream_.ends) {
    return;
  }
  while (must_wait(end_tick) && !stop_.load(std::memory_order_relaxed)) {
    progress_.fetch_add(1, std::memory_order_relaxed);
    std::this_thread::sleep_for(std::chrono::microseconds(100));
  }
}

bool Acquirer::must_wait(Tick end_tick) const noexcept {
  const std::optional<Tick> needed = teller_.oldest_needed();
  return teller_.is_behind() ||
         (needed && end_tick - *needed > static_cast<Tick>(ring_.capacity_samples()));
}

void Acquirer::handle_disconnect() {
  if (stop_.load()) {
    return;
  }
  connected_.store(false);
  if (stream_.ends) {
    end_capture();  // a replay waits for its next capture, and has played this one to its end
  } else {
    windows_.interrupt();
  }
  tell(AcquisitionEvent::Kind::disconnected);
  std::int64_t pause_ms = kFirstPause_ms;
  bool told_changed = false;
  while (!stop_.load()) {
    pause(pause_ms);
    pause_ms = std::min(2 * pause_ms, kLongestPause_ms);
    progress_.fetch_add(1, std::memory_order_relaxed);
    if (stop_.load() || !digitiser_.reconnect()) {
      continue;
    }
    if (same_stream()) {
      break;
    }
    if (!told_changed) {
      tell(AcquisitionEvent::Kind::changed);
      told_changed = true;
    }
  }
  if (stop_.load()) {
    return;
  }
  reconnects_.fetch_add(1, std::memory_order_relaxed);
  streaming_ = false;  // the pre-trigger of the next window does not reach back over the hole
  connected_.store(true);
  tell(AcquisitionEvent::Kind::reconnected);
}

bool Acquirer::same_stream() const {
  const StreamInfo& now = digitiser_.info();
  return now.rate == stream_.rate && now.format == stream_.format &&
         std::equal(now.channels.begin(), now.channels.end(), stream_.channels.begin(),
                    stream_.channels.end(), same_channel);
}

void Acquirer::pause(std::int64_t milliseconds) const {
  constexpr std::int64_t kSlice_ms = 20;
  for (std::int64_t waited = 0; waited < milliseconds && !stop_.load(); waited += kSlice_ms) {
    std::this_thread::sleep_for(std::chrono::milliseconds(kSlice_ms));
  }
}

}  // namespace kolsky
