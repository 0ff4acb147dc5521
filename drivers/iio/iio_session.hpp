#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "drivers/digitiser/open.hpp"
#include "drivers/iio/device_selection.hpp"
#include "drivers/iio/iio_handles.hpp"
#include "drivers/iio/overflow_register.hpp"

namespace kolsky {

/// One life of the connection to a device: context, channels, buffer. It is never mended: whatever
/// breaks it (a stalled network leaves libiio's stream out of step), it is destroyed and another
/// one opened.
class IioSession {
 public:
  /// Connects, chooses device and channels, settles the rate. @throws InputError
  IioSession(const std::string& uri, const DigitiserOptions& options);

  [[nodiscard]] const StreamInfo& info() const noexcept { return info_; }

  /// Kernel buffers, channel enables, then the buffer, in that order. @throws InputError,
  /// InputError
  void start();

  /// How many blocks the device keeps while nobody reads.
  [[nodiscard]] unsigned int kernel_buffers() const noexcept { return kernel_buffers_; }

  /// Waits for the next scans. @return how many bytes came, or a negative errno
  [[nodiscard]] ssize_t refill() noexcept;

  /// The scans of the last refill. The layout is asked for anew each time: other channels may have
  /// come in between, and a local buffer moves.
  struct Scans {
    std::size_t count = 0;
    std::ptrdiff_t stride = 0;
    bool whole = false;  ///< the bytes are scans that hold every channel asked for
  };
  [[nodiscard]] Scans scans() const noexcept;

  /// @param out  count x sample_bytes(info().format)
  void decode(std::size_t channel, const Scans& scans, std::byte* out) const noexcept;

  /// The format of the channel that numbers the samples, if there is one.
  [[nodiscard]] const std::optional<ScanFormat>& counter() const noexcept {
    return counter_format_;
  }
  /// Its bytes in the first scan. @pre counter()
  [[nodiscard]] const std::byte* counter_values() const noexcept;

  /// The register that reports lost samples, where the device has it and does not number its
  /// samples.
  [[nodiscard]] OverflowRegister* overflow_register() noexcept {
    return overflow_ ? &*overflow_ : nullptr;
  }

  /// Makes a waiting refill return, from any thread while the session lives.
  void cancel() noexcept;

 private:
  void choose(const DigitiserOptions& options);
  void find_loss_reports();
  [[nodiscard]] StreamInfo describe(const std::string& uri, double rate_Hz,
                                    const DigitiserOptions& options) const;
  [[nodiscard]] std::string loss_report() const;
  void enable_channels();
  [[nodiscard]] const std::byte* first_value(const iio_channel* channel) const noexcept;

  ContextHandle context_;
  iio_device* device_ = nullptr;
  std::vector<ScanChannel> channels_;
  std::vector<ScanDecoder> decoders_;
  iio_channel* counter_ = nullptr;
  std::optional<ScanFormat> counter_format_;
  std::ptrdiff_t least_scan_bytes_ = 0;
  std::optional<OverflowRegister> overflow_;
  StreamInfo info_;
  unsigned int kernel_buffers_ = 4;  // what a device has that cannot be told
  BufferHandle buffer_;
};

}  // namespace kolsky
