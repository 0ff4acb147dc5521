#include "drivers/simulated/kernel_buffers.hpp"

#include <algorithm>

namespace kolsky {

KernelBuffers::KernelBuffers(Tick first_tick, int count)
    : returned_(static_cast<std::size_t>(std::max(count, 1)), first_tick), start_(first_tick) {}

void KernelBuffers::finish_block(Tick end, Tick now) {
  returned_[next_buffer_] = now;
  next_buffer_ = (next_buffer_ + 1) % returned_.size();
  start_ = std::max(end, returned_[next_buffer_]);
  lost_before_ = start_ - end;
}

bool KernelBuffers::overrun(Tick now, Tick block_ticks) const noexcept {
  return now > start_ + block_ticks * static_cast<Tick>(returned_.size());
}

}  // namespace kolsky
