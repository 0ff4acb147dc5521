#pragma once

#include <functional>
#include <memory>
#include <string>

#include "drivers/digitiser/digitiser.hpp"

namespace kolsky {

/// A driver with a source behind it that is known to the sample: channel c carries pattern_code(c,
/// ...), its values are (code + 3 + c) * (c + 1) / 4096 volts.
class Rig {
 public:
  virtual ~Rig() = default;
  Rig() = default;
  Rig(const Rig&) = delete;
  Rig& operator=(const Rig&) = delete;

  static constexpr std::size_t kChannels = 2;
  static constexpr double kRate_Hz = 1e6;
  static constexpr std::size_t kBlockSamples = 1024;
  static constexpr double kScale_V[] = {1.0 / 4096.0, 2.0 / 4096.0};
  static constexpr double kOffset[] = {3.0, 4.0};

  static constexpr Tick kSamples = 400'000;

  /// @param speed    factor on the real rate; 0: as fast as it is read
  /// @param samples  where the stream ends, if it does
  [[nodiscard]] virtual std::unique_ptr<Digitiser> open(double speed, Tick samples) = 0;
  [[nodiscard]] std::unique_ptr<Digitiser> open(double speed) { return open(speed, kSamples); }

  /// A stream of some known hole, of `hole_samples` where that is not 0.
  [[nodiscard]] virtual std::unique_ptr<Digitiser> open_with_hole() = 0;
  /// After some reading: makes the hole, if it is not in the stream anyway.
  virtual void make_hole() {}
  [[nodiscard]] virtual Tick hole_samples() const { return 0; }
  /// Whether the driver says `overflow` before it: a stored hole is no news.
  [[nodiscard]] virtual bool announces_holes() const = 0;

  /// A stream that will break off, and what breaks and mends it.
  [[nodiscard]] virtual std::unique_ptr<Digitiser> open_to_break() = 0;
  virtual void break_off() = 0;
  virtual void mend() = 0;

  [[nodiscard]] virtual bool simulated() const = 0;
};

/// The iio driver at a simulated digitiser, through libiio and TCP.
[[nodiscard]] std::unique_ptr<Rig> make_iio_rig();
/// The replay driver with one capture.
[[nodiscard]] std::unique_ptr<Rig> make_capture_rig();
/// The replay driver with a folder of several.
[[nodiscard]] std::unique_ptr<Rig> make_folder_rig();

}  // namespace kolsky
