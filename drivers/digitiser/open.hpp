#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "drivers/digitiser/digitiser.hpp"

namespace kolsky {

/// What is asked of a digitiser when it is opened.
struct DigitiserOptions {
  std::vector<std::string> channels;  ///< the digitiser's channels to read, in the bench's gauge
                                      ///< order; empty: the first `channel_count` voltage channels
  std::size_t channel_count = 0;      ///< 0 without names: all
  std::vector<std::string> gauges;    ///< the bench's: without `channels` a capture's are taken by
                                      ///< these names where it has them, by their place else
  std::vector<std::string> units;  ///< "V" or "strain" per channel, as the gauges want it; what is
                                   ///< left out: "V" of a device, its own of a capture
  double sampling_frequency_Hz =
      0.0;                        ///< set where the device can, read back, refused where it differs
  std::size_t block_samples = 0;  ///< 0: what arrives in about a millisecond, see default_block
  std::string device;             ///< IIO device name; empty: the first with enough input channels
  double replay_speed = 0.0;      ///< factor on the real rate; 0: as fast as possible
  /// For how long a replay waits for a capture that has gone: a file server may be away for a
  /// moment.
  std::chrono::milliseconds replay_patience{10'000};
  /// Told what a replay meets while it runs; by the reading thread.
  std::function<void(const std::string& text)> tell = [](const std::string&) {};
};

/// Samples that arrive in about a millisecond, a power of two: short against what a shot's result
/// may take, long against the cost of a read.
[[nodiscard]] std::size_t default_block(double arrival_rate_Hz);

/// Opens `replay:CAPTURE-or-folder` or any libiio URI (`ip:host:port`, `usb:...`, `local:`).
/// @throws InputError with the URI as its place
[[nodiscard]] std::unique_ptr<Digitiser> open_digitiser(const std::string& uri,
                                                        const DigitiserOptions& options);

}  // namespace kolsky
