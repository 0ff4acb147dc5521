#pragma once

#include <cstdint>
#include <map>
#include <string>

#include "daemon/acquisition/acquisition_event.hpp"
#include "daemon/acquisition/sample_ring.hpp"
#include "daemon/config.hpp"
#include "drivers/digitiser/digitiser.hpp"
#include "processing/base/shot.hpp"

namespace kolsky {

/// A shot without its samples: the apparatus and the channels in force, copied into every shot.
/// @throws InputError where the digitiser's channels are not what the bench says: number or unit
[[nodiscard]] Shot blank_shot(const DaemonConfig& config, const Apparatus& apparatus,
                              const StreamInfo& stream);

/// Copies a window's codes out of the ring into a shot made from `blank`. Ticks in the result count
/// from the stream's start.
SampleRing::CopyStatus cut_window(const SampleRing& ring, const Window& window, Shot& shot);

/// A shot like those to come, with pulses at the times the bench's bars give: what plans, tables
/// and buffers are made for before the first real one.
[[nodiscard]] Shot rehearsal_shot(const Shot& blank, std::int64_t pre_samples,
                                  std::int64_t post_samples);

}  // namespace kolsky
