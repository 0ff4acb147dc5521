#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <optional>

#include "daemon/acquisition/acquisition_event.hpp"

namespace kolsky {

/// What the acquisition thread says to the recorder. The queue may be full, and the thread does not
/// wait: what finds no room is lost but for holes, which are told later, ahead of what comes next.
/// A window must never look whole because the news of its gap found no room.
class EventTeller {
 public:
  /// @param events  outlives this
  explicit EventTeller(AcquisitionQueue& events) : events_(events) {}

  // Acquisition thread.
  void tell(const AcquisitionEvent& event);
  /// Holes that wait are told as one, of unknown extent.
  void tell_gap(const AcquisitionEvent& gap);
  /// The recorder needs the window's samples until it releases it.
  /// @return whether there was room to tell it
  [[nodiscard]] bool hand_over(const Window& window);
  /// So much waits to be heard that a stream which can wait had better do so.
  [[nodiscard]] bool is_behind() const noexcept;
  /// First tick of the oldest window that was handed over and is needed yet; none: no window is.
  [[nodiscard]] std::optional<Tick> oldest_needed() const noexcept;

  // Recorder: the samples of the oldest window handed over are no longer needed.
  void release_window() noexcept { released_.fetch_add(1, std::memory_order_release); }

  // Any thread.
  [[nodiscard]] bool any_window_needed() const noexcept {
    return handed_.load() != released_.load();
  }

 private:
  [[nodiscard]] bool said(const AcquisitionEvent& event);
  [[nodiscard]] bool say_held_gap();

  AcquisitionQueue& events_;
  std::optional<AcquisitionEvent> held_gap_;  ///< found no room
  std::array<Tick, AcquisitionQueue::capacity()> handed_first_{};
  std::atomic<std::uint32_t> handed_{0};
  std::atomic<std::uint32_t> released_{0};
};

}  // namespace kolsky
