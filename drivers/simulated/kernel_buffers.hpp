#pragma once

#include <cstdint>
#include <vector>

#include "processing/base/time.hpp"

namespace kolsky {

/// The ring of buffers that a converter's DMA fills and a client empties, as arithmetic on ticks:
/// nothing is stored, so a block is made only when it is sent. A block begins where the last one
/// ended, or, if the client then held every buffer, when it gave one back; what the converter gave
/// in between is lost.
class KernelBuffers {
 public:
  /// @param first_tick  the converter's tick when the stream was opened
  /// @param count       buffers in the ring, at least 1
  KernelBuffers(Tick first_tick, int count);

  /// First tick of the block that the client gets next.
  [[nodiscard]] Tick block_start() const noexcept { return start_; }

  /// Samples lost just before that block.
  [[nodiscard]] Tick lost_before() const noexcept { return lost_before_; }

  /// The block is complete at `end` and the client gave its buffer back at `now`. Starts the next
  /// block.
  /// @param now  the converter's tick, at least `end`
  void finish_block(Tick end, Tick now);

  /// Whether by now the converter has run out of buffers since the client last gave one back.
  /// @param block_ticks  how many ticks a block spans
  [[nodiscard]] bool overrun(Tick now, Tick block_ticks) const noexcept;

 private:
  std::vector<Tick> returned_;  ///< when each buffer of the ring was last given back
  std::size_t next_buffer_ = 0;
  Tick start_;
  Tick lost_before_ = 0;
};

}  // namespace kolsky
