#pragma once

#include <deque>
#include <vector>

#include "daemon/acquisition/acquisition_event.hpp"
#include "processing/base/shot.hpp"

namespace kolsky {

/// The holes in the stream that a window may still contain, in order.
class GapLog {
 public:
  void add(const Gap& gap);
  /// The holes between samples of [first_tick, end_tick).
  [[nodiscard]] std::vector<Gap> within(Tick first_tick, Tick end_tick) const;
  /// The window without a hole at either end: it begins after one that reaches into its beginning,
  /// and is interrupted where one begins that reaches over its end.
  [[nodiscard]] Window without_holes_at_ends(Window window) const;
  /// Forgets what ends before this tick.
  void forget_before(Tick tick);

 private:
  std::deque<Gap> gaps_;
};

}  // namespace kolsky
