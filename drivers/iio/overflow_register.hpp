#pragma once

#include <iio.h>

#include <cstdint>

namespace kolsky {

/// The receive status register of ADI's FPGA converter cores, 0x80000088, through the device's
/// debug access: its value 4 says that the DMA had nowhere to put samples. It is the only overflow
/// report there is. One poll is two round trips on the control connection (a write of the address,
/// a read of the value), so polls are at least 20 ms and 50 polls' duration apart: 2 % of the
/// reading thread's time at most, and the device goes on filling its kernel buffers meanwhile.
/// Polled on the reading thread because a USB device has but one connection, and because then it is
/// known which blocks were read before the flag was last seen clear.
class OverflowRegister {
 public:
  /// Probes the register: there, with no bit set that the cores do not define, and cleared by
  /// writing it.
  explicit OverflowRegister(iio_device* device);

  [[nodiscard]] bool works() const noexcept { return works_; }

  enum class Answer {
    not_due,
    clear,
    overflow,  ///< since the last poll; cleared
    failed,    ///< the control connection is gone
  };
  /// @param now_ns   CLOCK_MONOTONIC
  /// @param at_once  even if the last poll is not long ago
  Answer poll(std::int64_t now_ns, bool at_once);

 private:
  [[nodiscard]] bool probe() const;

  iio_device* device_;
  bool works_;
  std::int64_t next_ns_ = 0;
};

}  // namespace kolsky
