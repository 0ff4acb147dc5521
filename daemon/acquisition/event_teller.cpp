#include "daemon/acquisition/event_teller.hpp"

namespace kolsky {

void EventTeller::tell(const AcquisitionEvent& event) {
  static_cast<void>(said(event));
}

void EventTeller::tell_gap(const AcquisitionEvent& gap) {
  if (said(gap)) {
    return;
  }
  if (held_gap_) {
    held_gap_->gap.samples += gap.gap.samples;
    held_gap_->gap.known = false;
  } else {
    held_gap_ = gap;
  }
}

bool EventTeller::hand_over(const Window& window) {
  const std::uint32_t handed = handed_.load(std::memory_order_relaxed);
  handed_first_[handed % handed_first_.size()] = window.first_tick;
  handed_.store(handed + 1, std::memory_order_release);
  AcquisitionEvent event;
  event.kind = AcquisitionEvent::Kind::window;
  event.tick = window.end_tick;
  event.window = window;
  if (said(event)) {
    return true;
  }
  released_.fetch_add(1, std::memory_order_relaxed);
  return false;
}

bool EventTeller::is_behind() const noexcept {
  return events_.size() > AcquisitionQueue::capacity() / 2;
}

std::optional<Tick> EventTeller::oldest_needed() const noexcept {
  const std::uint32_t released = released_.load(std::memory_order_acquire);
  if (released == handed_.load(std::memory_order_relaxed)) {
    return std::nullopt;
  }
  return handed_first_[released % handed_first_.size()];
}

bool EventTeller::said(const AcquisitionEvent& event) {
  return say_held_gap() && events_.push(event);
}

bool EventTeller::say_held_gap() {
  if (held_gap_ && events_.push(*held_gap_)) {
    held_gap_.reset();
  }
  return !held_gap_;
}

}  // namespace kolsky
