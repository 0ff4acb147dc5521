#pragma once

#include <iio.h>

#include <optional>
#include <vector>

#include "drivers/iio/device_selection.hpp"

namespace kolsky {

/// Sets the device's sampling rate where it differs from the asked one, and reads back what it then
/// is. A device without a `sampling_frequency` attribute is taken at the asked rate.
/// @param asked_Hz  0: whatever the device has
/// @return the device's own figure
/// @throws InputError where the rate is off by more than 1e-6 of the asked one, or nobody knows it
[[nodiscard]] double settle_sampling_rate(const iio_device* device,
                                          const std::vector<ScanChannel>& channels,
                                          double asked_Hz);

}  // namespace kolsky
