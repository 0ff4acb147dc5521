#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

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

/// The capture of a replay that holds this tick of the stream; null outside a replay.
[[nodiscard]] const PlayedCapture* capture_at(const std::vector<PlayedCapture>& captures,
                                              Tick tick);

/// Files with a shot what is filed with the capture that it was replayed from: speeds, temperature
/// and specimen are facts of the shot and not of the replay. `replayed_from` names the capture.
void file_facts_of(const PlayedCapture& capture, Shot& shot);

/// Says that what should follow the shot's last sample is missing: one sample is added that repeats
/// the last code, and a hole of unknown length stands before it. A gap lies between samples, here
/// as everywhere, so that a replay has it too.
void mark_interrupted(Shot& shot);

/// A shot like those to come, with pulses at the times the bench's bars give: what plans, tables
/// and buffers are made for before the first real one.
[[nodiscard]] Shot rehearsal_shot(const Shot& blank, std::int64_t pre_samples,
                                  std::int64_t post_samples);

}  // namespace kolsky
