#pragma once

#include <cstdint>

#include "daemon/acquisition/event_queue.hpp"
#include "processing/base/shot.hpp"

namespace kolsky {

/// How a window came to its end.
enum class WindowEnd {
  full,         ///< all its samples came
  capture_end,  ///< the replayed capture has no more
  interrupted,  ///< the stream broke off (disconnected, stopped): what follows is missing
};

/// The samples [first_tick, end_tick) that belong to a trigger.
struct Window {
  TriggerEvent trigger;
  Tick first_tick = 0;
  Tick end_tick = 0;
  WindowEnd end = WindowEnd::full;
  std::int64_t trigger_monotonic_ns = 0;
  std::int64_t complete_monotonic_ns = 0;  ///< when its last sample was in hand
};

/// What the acquisition thread tells the recorder, in the order in which it happened in the stream.
struct AcquisitionEvent {
  enum class Kind {
    triggered,       ///< a window was opened
    window,          ///< a window is complete and in the ring
    window_refused,  ///< triggered with too many windows open; the trigger is lost
    gap,             ///< samples are missing
    overflow,        ///< the digitiser says that it lost samples
    disconnected,
    reconnected,
    changed,  ///< the digitiser came back with another rate, format or scale; not used
    end_of_capture,
  };
  Kind kind = Kind::triggered;
  Tick tick = 0;
  Window window;
  Gap gap;
};

using AcquisitionQueue = EventQueue<AcquisitionEvent, 256>;

}  // namespace kolsky
