#pragma once

#include <deque>
#include <vector>

#include "processing/base/shot.hpp"

namespace kolsky {

/// The holes in the stream that a window may still contain, in order.
class GapLog {
 public:
  void add(const Gap& gap);
  /// The holes that touch the samples [first_tick, end_tick).
  [[nodiscard]] std::vector<Gap> within(Tick first_tick, Tick end_tick) const;
  /// Forgets what ends before this tick.
  void forget_before(Tick tick);

 private:
  std::deque<Gap> gaps_;
};

}  // namespace kolsky
