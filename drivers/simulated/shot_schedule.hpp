#pragma once

#include <cstddef>
#include <deque>

#include "processing/base/time.hpp"

namespace kolsky {

/// When shots were fired. A client may be behind by as much as the kernel buffers hold, so past
/// shots are remembered, the last few hundred of them.
class ShotSchedule {
 public:
  struct Fired {
    Tick tick = 0;
    std::size_t number = 0;  ///< 0 is the first
  };

  void fire(Tick tick) {
    fired_.push_back({tick, count_++});
    if (fired_.size() > kRemembered) {
      fired_.pop_front();
    }
  }
  void forget() { fired_.clear(); }

  /// Calls visit(fired) for the shots that may have samples in [first, end), the latest first.
  template <typename Visit>
  void overlapping(Tick first, Tick end, Tick shot_samples, Visit visit) const {
    for (auto shot = fired_.rbegin(); shot != fired_.rend(); ++shot) {
      if (shot->tick + shot_samples <= first) {
        return;
      }
      if (shot->tick < end) {
        visit(*shot);
      }
    }
  }

 private:
  static constexpr std::size_t kRemembered = 512;
  std::deque<Fired> fired_;
  std::size_t count_ = 0;
};

}  // namespace kolsky
