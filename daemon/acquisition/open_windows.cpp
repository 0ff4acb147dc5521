#include "daemon/acquisition/open_windows.hpp"

#include <algorithm>
#include <cmath>

namespace kolsky {

OpenWindows::OpenWindows(const StreamInfo& stream, std::size_t ring_samples, EventTeller& teller)
    : stream_(stream), ring_samples_(static_cast<Tick>(ring_samples)), teller_(teller) {}

void OpenWindows::reach(Tick end, std::int64_t monotonic_ns) {
  end_tick_ = end;
  end_monotonic_ns_ = monotonic_ns;
}

void OpenWindows::trigger_at(const TriggerEvent& trigger, const AcquisitionPlan& plan) {
  const Window window = about(trigger, plan);
  tell_triggered(window);
  open(window);
}

void OpenWindows::take_mark(const TriggerEvent& mark, const AcquisitionPlan& plan) {
  if (!stream_.ends || !fits_ring(end_tick_ - capture_start_)) {
    trigger_at(mark, plan);
    return;
  }
  opened_ = 0;  // what the software made of this capture before its own mark came
  open_count_.store(1);
  whole_capture_ = mark;
  tell_triggered({.trigger = mark, .first_tick = capture_start_, .end_tick = end_tick_});
}

void OpenWindows::cut_if_too_long(Tick end, const AcquisitionPlan& plan) {
  if (!whole_capture_ || fits_ring(end - capture_start_)) {
    return;
  }
  const TriggerEvent mark = *whole_capture_;
  whole_capture_.reset();
  open(about(mark, plan));
  close_full();
}

void OpenWindows::close_full() {
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

void OpenWindows::end_capture() {
  if (whole_capture_) {
    hand_over(whole(*whole_capture_));
    whole_capture_.reset();
  }
  end_all(WindowEnd::capture_end);
}

void OpenWindows::interrupt() {
  if (whole_capture_) {
    open(whole(*whole_capture_));
    whole_capture_.reset();
  }
  end_all(WindowEnd::interrupted);
}

/// With a further block beside it.
bool OpenWindows::fits_ring(Tick length) const {
  return length + static_cast<Tick>(stream_.max_block_samples) <= ring_samples_;
}

Window OpenWindows::about(const TriggerEvent& trigger, const AcquisitionPlan& plan) const {
  return {.trigger = trigger,
          .first_tick = std::max(capture_start_, trigger.tick - plan.pre_samples),
          .end_tick = trigger.tick + plan.post_samples,
          .trigger_monotonic_ns = monotonic_at(trigger.tick)};
}

Window OpenWindows::whole(const TriggerEvent& mark) const {
  return {.trigger = mark,
          .first_tick = capture_start_,
          .end_tick = end_tick_,
          .trigger_monotonic_ns = monotonic_at(mark.tick)};
}

void OpenWindows::tell(AcquisitionEvent::Kind kind, const Window& window) {
  AcquisitionEvent event;
  event.kind = kind;
  event.tick = window.trigger.tick;
  event.window = window;
  teller_.tell(event);
}

void OpenWindows::tell_triggered(const Window& window) {
  triggers_.fetch_add(1, std::memory_order_relaxed);
  tell(AcquisitionEvent::Kind::triggered, window);
}

void OpenWindows::open(const Window& window) {
  if (opened_ == kMost) {
    refused_.fetch_add(1, std::memory_order_relaxed);
    tell(AcquisitionEvent::Kind::window_refused, window);
    return;
  }
  open_[opened_++] = window;
  open_count_.store(opened_, std::memory_order_relaxed);
}

void OpenWindows::end_all(WindowEnd end) {
  for (std::size_t i = 0; i < opened_; ++i) {
    open_[i].end_tick = std::min(open_[i].end_tick, end_tick_);
    open_[i].end = end;
  }
  close_full();
}

void OpenWindows::hand_over(const Window& window) {
  Window complete = window;
  complete.complete_monotonic_ns = end_monotonic_ns_;
  if (!teller_.hand_over(complete)) {
    refused_.fetch_add(1, std::memory_order_relaxed);
  }
}

std::int64_t OpenWindows::monotonic_at(Tick tick) const noexcept {
  const double before_s = static_cast<double>(end_tick_ - 1 - tick) / arrival_rate_Hz(stream_);
  return end_monotonic_ns_ - std::llround(before_s * 1e9);
}

}  // namespace kolsky
