#include "daemon/acquisition/acquirer.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
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
      events_(events),
      stream_(digitiser.info()),
      watch_(plan),
      quiet_(stream_.channels.size(), ChannelLevel(plan.trigger)),
      statistics_(stream_.channels.size()),
      levels_(stream_.channels.size()) {}

Acquirer::~Acquirer() {
  stop();
  delete next_watch_.load();
  delete retired_watch_.load();
}

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
  delete next_watch_.exchange(new Watch(plan));
  delete retired_watch_.exchange(nullptr);
}

void Acquirer::release_window() noexcept {
  released_.fetch_add(1, std::memory_order_release);
}

Acquirer::Counters Acquirer::counters() const noexcept {
  return {.samples_read = samples_read_.load(),
          .samples_missing = samples_missing_.load(),
          .gaps_of_unknown_length = unknown_gaps_.load(),
          .overflows = overflows_.load(),
          .reconnects = reconnects_.load(),
          .triggers = triggers_.load(),
          .windows_refused = refused_.load(),
          .progress = progress_.load()};
}

Acquirer::Level Acquirer::level(std::size_t channel) const noexcept {
  const AtomicLevel& level = levels_[channel];
  return {.baseline_codes = level.baseline.load(std::memory_order_relaxed),
          .noise_codes = level.noise.load(std::memory_order_relaxed),
          .level_codes = level.level.load(std::memory_order_relaxed),
          .constant_samples = level.constant.load(std::memory_order_relaxed),
          .learned = level.learned.load(std::memory_order_relaxed)};
}

void Acquirer::run() {
  go_real_time();
  Block block;
  block.channels.reserve(stream_.channels.size());
  while (!stop_.load(std::memory_order_relaxed)) {
    progress_.fetch_add(1, std::memory_order_relaxed);
    take_plan();
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
        close_capture();
        tell(AcquisitionEvent::Kind::end_of_capture);
        ended_.store(true);
        return;
    }
  }
  interrupt_windows();
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

void Acquirer::take_plan() {
  if (next_watch_.load(std::memory_order_relaxed) == nullptr ||
      retired_watch_.load(std::memory_order_relaxed) != nullptr) {
    return;
  }
  Watch* next = next_watch_.exchange(nullptr, std::memory_order_acquire);
  if (next != nullptr) {
    std::swap(watch_, *next);
    retired_watch_.store(next, std::memory_order_release);  // freed by another thread
    learn_anew();
  }
}

void Acquirer::learn_anew() {
  for (AtomicLevel& level : levels_) {
    level.learned.store(false, std::memory_order_relaxed);
  }
  watch_.trigger.reset();
  for (ChannelLevel& channel : quiet_) {
    channel.forget();
  }
}

void Acquirer::take(const Block& block) {
  const Tick block_end = block.first_tick + static_cast<Tick>(block.samples);
  if (block.starts_capture || !streaming_) {
    begin_capture(block);
  }
  note_missing(block);
  settle_long_mark(block);
  wait_for_room(block_end);
  ring_.write(block, statistics_);
  end_tick_ = block_end;
  end_monotonic_ns_ = block.monotonic_ns;
  samples_read_.fetch_add(block.samples, std::memory_order_relaxed);
  watch(block);
  follow_quiet_channels();
  close_full_windows();
  show_levels();
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
  tell_gap(event);
}

void Acquirer::begin_capture(const Block& block) {
  close_capture();
  const bool headless = block.starts_capture && block.missing_before.kind == Missing::Kind::known;
  streaming_ = true;
  capture_start_ = block.first_tick - (headless ? block.missing_before.samples : 0);
  capture_marked_ = false;
  learn_anew();
}

void Acquirer::watch(const Block& block) {
  if (block.mark) {
    take_mark(block, *block.mark);
  }
  const std::optional<TriggerEvent> event = feed_trigger(block);
  if (event && armed() && !capture_marked_) {
    trigger_at(*event);
  }
  if (force_.load(std::memory_order_relaxed) && force_.exchange(false)) {
    trigger_at({.tick = block.first_tick, .kind = TriggerKind::forced});
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

/// Their statistics were taken on the way into the ring; the samples are not looked at again.
void Acquirer::follow_quiet_channels() {
  for (std::size_t i = 0; i < quiet_.size(); ++i) {
    if (i != watch_.plan.trigger_channel) {
      quiet_[i].take(statistics_[i]);
    }
  }
}

void Acquirer::take_mark(const Block& block, const TriggerEvent& mark) {
  capture_marked_ = true;
  if (!armed()) {
    return;
  }
  const bool fits = end_tick_ - capture_start_ + static_cast<Tick>(stream_.max_block_samples) <=
                    static_cast<Tick>(ring_.capacity_samples());
  if (!stream_.ends || !fits) {
    trigger_at(mark);
    return;
  }
  opened_ = 0;  // what the software made of this capture before its own mark came
  open_count_.store(1);
  whole_capture_ = mark;
  triggers_.fetch_add(1, std::memory_order_relaxed);
  AcquisitionEvent event;
  event.kind = AcquisitionEvent::Kind::triggered;
  event.tick = mark.tick;
  event.window = {.trigger = mark,
                  .first_tick = capture_start_,
                  .end_tick = block.first_tick + static_cast<Tick>(block.samples)};
  tell(event);
}

void Acquirer::settle_long_mark(const Block& block) {
  if (!whole_capture_) {
    return;
  }
  const Tick length = block.first_tick + static_cast<Tick>(block.samples) - capture_start_;
  if (length + static_cast<Tick>(stream_.max_block_samples) <=
      static_cast<Tick>(ring_.capacity_samples())) {
    return;
  }
  const TriggerEvent mark = *whole_capture_;
  whole_capture_.reset();
  open_window({.trigger = mark,
               .first_tick = std::max(capture_start_, mark.tick - watch_.plan.pre_samples),
               .end_tick = mark.tick + watch_.plan.post_samples,
               .trigger_monotonic_ns = monotonic_at(mark.tick)});
  close_full_windows();
}

void Acquirer::trigger_at(const TriggerEvent& trigger) {
  triggers_.fetch_add(1, std::memory_order_relaxed);
  const Window window{
      .trigger = trigger,
      .first_tick = std::max(capture_start_, trigger.tick - watch_.plan.pre_samples),
      .end_tick = trigger.tick + watch_.plan.post_samples,
      .trigger_monotonic_ns = monotonic_at(trigger.tick)};
  AcquisitionEvent event;
  event.kind = AcquisitionEvent::Kind::triggered;
  event.tick = trigger.tick;
  event.window = window;
  tell(event);
  open_window(window);
}

void Acquirer::open_window(const Window& window) {
  if (opened_ == kOpenWindows) {
    refused_.fetch_add(1, std::memory_order_relaxed);
    AcquisitionEvent event;
    event.kind = AcquisitionEvent::Kind::window_refused;
    event.tick = window.trigger.tick;
    event.window = window;
    tell(event);
    return;
  }
  open_[opened_++] = window;
  open_count_.store(opened_, std::memory_order_relaxed);
}

void Acquirer::close_full_windows() {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < opened_; ++i) {
    if (open_[i].end_tick <= end_tick_) {
      hand_over(open_[i]);
    } else {
      open_[kept++] = open_[i];
    }
  }
  opened_ = kept;
  open_count_.store(opened_ + (whole_capture_ ? 1 : 0), std::memory_order_relaxed);
}

void Acquirer::close_capture() {
  if (overflow_pending_) {  // samples were lost, and none came after them
    overflow_pending_ = false;
    interrupt_windows();
    return;
  }
  if (whole_capture_) {
    hand_over({.trigger = *whole_capture_,
               .first_tick = capture_start_,
               .end_tick = end_tick_,
               .trigger_monotonic_ns = monotonic_at(whole_capture_->tick)});
    whole_capture_.reset();
  }
  for (std::size_t i = 0; i < opened_; ++i) {
    open_[i].end_tick = std::min(open_[i].end_tick, end_tick_);
    open_[i].end = WindowEnd::capture_end;
  }
  close_full_windows();
}

void Acquirer::interrupt_windows() {
  if (whole_capture_) {
    open_window({.trigger = *whole_capture_,
                 .first_tick = capture_start_,
                 .end_tick = end_tick_,
                 .trigger_monotonic_ns = monotonic_at(whole_capture_->tick)});
    whole_capture_.reset();
  }
  for (std::size_t i = 0; i < opened_; ++i) {
    open_[i].end_tick = std::min(open_[i].end_tick, end_tick_);
    open_[i].end = WindowEnd::interrupted;
  }
  close_full_windows();
}

void Acquirer::hand_over(const Window& window) {
  const std::uint32_t handed = handed_.load(std::memory_order_relaxed);
  handed_first_[handed % handed_first_.size()] = window.first_tick;
  handed_.store(handed + 1, std::memory_order_release);
  AcquisitionEvent event;
  event.kind = AcquisitionEvent::Kind::window;
  event.tick = window.end_tick;
  event.window = window;
  event.window.complete_monotonic_ns = end_monotonic_ns_;
  tell(event);
}

void Acquirer::tell(const AcquisitionEvent& event) {
  const bool said = say_held_gap() && events_.push(event);
  if (!said && event.kind == AcquisitionEvent::Kind::window) {
    refused_.fetch_add(1, std::memory_order_relaxed);
    released_.fetch_add(1, std::memory_order_relaxed);
  }
}

void Acquirer::tell_gap(const AcquisitionEvent& event) {
  if (say_held_gap() && events_.push(event)) {
    return;
  }
  // A window must never look whole because the news of its gap found no room: holes that wait are
  // told as one, of unknown extent.
  if (held_gap_) {
    held_gap_->gap.samples += event.gap.samples;
    held_gap_->gap.known = false;
  } else {
    held_gap_ = event;
  }
}

bool Acquirer::say_held_gap() {
  if (held_gap_ && events_.push(*held_gap_)) {
    held_gap_.reset();
  }
  return !held_gap_;
}

void Acquirer::tell(AcquisitionEvent::Kind kind) {
  AcquisitionEvent event;
  event.kind = kind;
  event.tick = end_tick_;
  tell(event);
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
  if (events_.size() > AcquisitionQueue::capacity() / 2) {
    return true;
  }
  const std::uint32_t released = released_.load(std::memory_order_acquire);
  if (released == handed_.load(std::memory_order_relaxed)) {
    return false;
  }
  const Tick needed = handed_first_[released % handed_first_.size()];
  return end_tick - needed > static_cast<Tick>(ring_.capacity_samples());
}

void Acquirer::handle_disconnect() {
  if (stop_.load()) {
    return;
  }
  connected_.store(false);
  if (stream_.ends) {
    close_capture();  // a replay waits for its next capture, and has played this one to its end
  } else {
    interrupt_windows();
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

void Acquirer::show_levels() {
  for (std::size_t i = 0; i < levels_.size(); ++i) {
    AtomicLevel& level = levels_[i];
    if (i == watch_.plan.trigger_channel) {
      show_trigger_level(level);
    } else {
      level.baseline.store(quiet_[i].baseline_codes(), std::memory_order_relaxed);
      level.noise.store(quiet_[i].noise_codes(), std::memory_order_relaxed);
      level.level.store(0.0, std::memory_order_relaxed);
      level.learned.store(quiet_[i].learned(), std::memory_order_relaxed);
    }
    follow_constant(level, statistics_[i]);
  }
}

void Acquirer::show_trigger_level(AtomicLevel& level) {
  const IncidentTrigger& trigger = watch_.trigger;
  level.baseline.store(trigger.baseline_codes(), std::memory_order_relaxed);
  level.noise.store(trigger.noise_codes(), std::memory_order_relaxed);
  level.level.store(trigger.level_codes(), std::memory_order_relaxed);
  watching_.store(trigger.ready(), std::memory_order_release);
  if (trigger.ready()) {  // stays so: in the hold-off after a trigger they are still known
    level.learned.store(true, std::memory_order_relaxed);
  }
}

void Acquirer::follow_constant(AtomicLevel& level, const RunStatistics& run) {
  const bool same = run.minimum == run.maximum && run.minimum == level.last_code;
  level.last_code = run.maximum;
  const std::int64_t before = same ? level.constant.load(std::memory_order_relaxed) : 0;
  level.constant.store(before + (same ? run.count : 0), std::memory_order_relaxed);
}

std::int64_t Acquirer::monotonic_at(Tick tick) const noexcept {
  const double before_s = static_cast<double>(end_tick_ - 1 - tick) / arrival_rate_Hz(stream_);
  return end_monotonic_ns_ - std::llround(before_s * 1e9);
}

}  // namespace kolsky
