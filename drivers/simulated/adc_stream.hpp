#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "drivers/simulated/fault_script.hpp"
#include "drivers/simulated/kernel_buffers.hpp"
#include "drivers/simulated/scan_layout.hpp"
#include "processing/base/time.hpp"

namespace kolsky {

class SimulatedAdc;

/// A client's open buffer on the converter. One thread reads; the stream ends with its destruction.
class AdcStream {
 public:
  /// Made by SimulatedAdc::open_stream, under its lock.
  AdcStream(SimulatedAdc& adc, std::vector<std::uint32_t> mask, Tick block_samples);
  ~AdcStream();
  AdcStream(const AdcStream&) = delete;
  AdcStream& operator=(const AdcStream&) = delete;

  /// What the scans of the present reply look like.
  [[nodiscard]] const ScanLayout& layout() const noexcept { return extra_ ? *extra_ : asked_; }

  /// When the block in progress is complete, as known at `now`: not later than that once it can be
  /// read. The caller's `now`, not a later one, says whether it can.
  [[nodiscard]] std::chrono::steady_clock::time_point due(
      std::chrono::steady_clock::time_point now);

  /// How many samples of the complete block are still to be read. @pre it was due
  [[nodiscard]] std::size_t available() const noexcept { return left_; }

  /// The next fault that the script wants acted out before this block is sent. @pre it was due
  [[nodiscard]] std::optional<Fault> take_fault();
  [[nodiscard]] bool fault_pending() const noexcept { return !faults_.empty(); }

  /// Adds a channel that was not asked for to the scans of this reply. @return false if there is
  /// none
  bool add_channel();
  void end_reply() { extra_.reset(); }

  /// Writes the next scans of the block, at most what is available. With the last of them the
  /// client has given the buffer back. @pre out.size() is a multiple of layout().bytes()
  void read(std::span<std::byte> out);

 private:
  friend class SimulatedAdc;

  /// Consecutive ticks of a block. What is lost before them counts once the first of them is read.
  struct Run {
    Tick first = 0;
    Tick samples = 0;
    Tick overrun_before = 0;
    Tick injected_before = 0;
  };

  void plan_block();
  void apply(const FaultQueue::Due& due);
  void fill(Tick first, std::span<std::byte> out);
  void clip(Tick first, std::span<std::int32_t> codes) const;
  void count_losses(Run& run);
  void finish_block();

  SimulatedAdc& adc_;
  ScanLayout asked_;
  std::optional<ScanLayout> extra_;
  Tick block_samples_;
  KernelBuffers buffers_;
  bool planned_ = false;
  std::vector<Run> runs_;  ///< what of the block is still to be read, backwards
  std::size_t left_ = 0;
  Tick block_end_ = 0;
  std::vector<Fault> faults_;  ///< of this block, backwards
  std::vector<Run> clipped_;
  Tick read_until_ = 0;      ///< the tick after the last one read
  bool fault_acts_ = false;  ///< what is lost from here on, the script has lost
  std::vector<std::int32_t> codes_;
};

}  // namespace kolsky
