#pragma once

#include <iio.h>

#include <string>
#include <vector>

#include "drivers/digitiser/open.hpp"
#include "drivers/iio/scan_format.hpp"

namespace kolsky {

/// One channel that was asked for: where its codes are and what they mean.
struct ScanChannel {
  iio_channel* channel = nullptr;
  ScanFormat format;
  ChannelInfo info;
};

/// The device named in the options by id, name or label; else the first that can stream as many
/// voltage channels as are asked for. @throws InputError that lists what there is
[[nodiscard]] iio_device* choose_device(const iio_context* context,
                                        const DigitiserOptions& options);

/// The channels asked for, by id, name or label, in that order; without names the first voltage
/// channels. Volts come from `scale` (millivolts) and `offset`, strain from `strain_scale` (strain
/// per code) and `offset`. @throws InputError where one is absent, no input, not streamable, named
/// twice, or does not say what its codes mean
[[nodiscard]] std::vector<ScanChannel> choose_channels(const iio_device* device,
                                                       const DigitiserOptions& options);

/// The format of a channel's values in a scan. @throws InputError where it is none that is known
[[nodiscard]] ScanFormat scan_format(const iio_channel* channel);

/// The channel that numbers the samples (type "count", id count0), if the device has one.
[[nodiscard]] iio_channel* find_counter(const iio_device* device);

/// "name (id)", or the id where there is no name.
[[nodiscard]] std::string device_title(const iio_device* device);

}  // namespace kolsky
