#pragma once

#include <iio.h>

#include <cstdint>

namespace kolsky {

/// The receive status register of ADI's FPGA converter cores, 0x80000088, through the device's
/// debug access: its value 4 says that samples had nowhere to go. It is the only overflow report
/// there is.
///
/// A poll is two round trips on the control connection (a write of the address, a read of the
/// value), so polls take at most a third of the reading thread's time, most of which it waits
/// anyway; near the digitiser (0.1 ms a poll) that is one for every block of a millisecond. They
/// belong between a refill and the delivery of its samples: then a flag is known before the samples
/// after the loss are handed on. They are made by the reading thread because a USB device has but
/// one connection, which libiio shares out under a lock.
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
