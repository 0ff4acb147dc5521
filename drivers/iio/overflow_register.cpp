#include "drivers/iio/overflow_register.hpp"

#include "drivers/iio/monotonic.hpp"

namespace kolsky {
namespace {

constexpr std::uint32_t kStatusRegister = 0x80000088;
constexpr std::uint32_t kDefinedBits = 0x7;
constexpr std::uint32_t kOverflow = 0x4;
constexpr std::int64_t kPausePerDuration = 2;

}  // namespace

OverflowRegister::OverflowRegister(iio_device* device) : device_(device), works_(probe()) {}

bool OverflowRegister::probe() const {
  std::uint32_t value = 0;
  if (iio_device_find_debug_attr(device_, "direct_reg_access") == nullptr ||
      iio_device_reg_read(device_, kStatusRegister, &value) != 0 || (value & ~kDefinedBits) != 0) {
    return false;
  }
  if ((value & kOverflow) == 0) {
    return true;
  }
  // A flag from before this stream. What does not clear is not this register.
  return iio_device_reg_write(device_, kStatusRegister, kOverflow) == 0 &&
         iio_device_reg_read(device_, kStatusRegister, &value) == 0 && (value & kOverflow) == 0;
}

OverflowRegister::Answer OverflowRegister::poll(std::int64_t now_ns, bool at_once) {
  if (!works_ || (now_ns < next_ns_ && !at_once)) {
    return Answer::not_due;
  }
  std::uint32_t value = 0;
  int error = iio_device_reg_read(device_, kStatusRegister, &value);
  const bool overflow = error == 0 && (value & kOverflow) != 0;
  if (overflow) {
    error = iio_device_reg_write(device_, kStatusRegister, kOverflow);
  }
  const std::int64_t done_ns = monotonic_ns();
  next_ns_ = done_ns + kPausePerDuration * (done_ns - now_ns);
  if (error != 0) {
    return Answer::failed;
  }
  return overflow ? Answer::overflow : Answer::clear;
}

}  // namespace kolsky
