#pragma once

#include <string>
#include <vector>

#include "kolsky/v1/kolsky.pb.h"
#include "processing/base/shot.hpp"

// Packed waveforms. For the .cpp files that build or read messages.
namespace kolsky::wire {

/// Raw codes, as INT16 where `bits` is at most 16 and INT32 above. Time fields are left as they
/// are.
/// @throws InputError where a code does not fit
void pack_codes(const ChannelRecord& channel, v1::Waveform& waveform);
/// @param place  of the waveform in its message, for errors
[[nodiscard]] ChannelRecord unpack_codes(const v1::Waveform& waveform, const std::string& place);

/// Values as FLOAT64, bit for bit.
void pack_values(const std::string& name, const std::string& unit,
                 const std::vector<double>& values, v1::Waveform& waveform);
[[nodiscard]] std::vector<double> unpack_values(const v1::Waveform& waveform,
                                                const std::string& place);

}  // namespace kolsky::wire
