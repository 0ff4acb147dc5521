#include "daemon/shots/gap_log.hpp"

namespace kolsky {

void GapLog::add(const Gap& gap) {
  gaps_.push_back(gap);
}

std::vector<Gap> GapLog::within(Tick first_tick, Tick end_tick) const {
  std::vector<Gap> found;
  for (const Gap& gap : gaps_) {
    // A hole of unknown length takes no ticks: it is inside when samples of the window lie on both
    // sides of it.
    const bool inside = gap.samples > 0
                            ? gap.first_tick < end_tick && gap.first_tick + gap.samples > first_tick
                            : gap.first_tick > first_tick && gap.first_tick < end_tick;
    if (inside) {
      found.push_back(gap);
    }
  }
  return found;
}

void GapLog::forget_before(Tick tick) {
  while (!gaps_.empty() && gaps_.front().first_tick + gaps_.front().samples < tick) {
    gaps_.pop_front();
  }
}

}  // namespace kolsky
