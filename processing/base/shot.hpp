#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "processing/base/bench.hpp"
#include "processing/base/material.hpp"
#include "processing/base/reduction_request.hpp"
#include "processing/base/time.hpp"

namespace kolsky {

/// One digitiser channel over a shot: raw codes and what turns them into the gauge's unit,
/// value = (code + offset) * scale.
struct ChannelRecord {
  std::string gauge;               ///< name in the bench
  std::string unit;                ///< of the values: "V" or "strain"
  double scale = 1.0;              ///< unit per code
  double offset = 0.0;             ///< codes
  int bits = 16;                   ///< of the converter; at most 16 are stored as 16-bit integers
  std::int32_t code_min = -32768;  ///< codes at or beyond these are clipped
  std::int32_t code_max = 32767;
  std::vector<std::int32_t> codes;

  [[nodiscard]] double value(std::int32_t code) const noexcept {
    return (static_cast<double>(code) + offset) * scale;
  }
  friend bool operator==(const ChannelRecord&, const ChannelRecord&) = default;
};

/// Samples that are not there. In a window with gaps the codes after it follow at their true ticks;
/// the hole itself is filled with the last code before it and named here.
struct Gap {
  Tick first_tick = 0;       ///< of the first missing sample
  std::int64_t samples = 0;  ///< how many are missing; 0 where nobody knows
  bool known = true;
  friend bool operator==(const Gap&, const Gap&) = default;
};

enum class TriggerKind {
  incident,  ///< the software trigger saw the incident pulse
  forced,    ///< an operator asked for a window
  marked,    ///< the stream itself carried the mark: a replayed shot or a hardware trigger
};

/// When the shot began: tick + fraction, in samples, with its one-sigma error.
struct TriggerEvent {
  Tick tick = 0;
  double fraction = 0.0;  ///< in [0, 1)
  double sigma_samples = 0.0;
  TriggerKind kind = TriggerKind::incident;
  friend bool operator==(const TriggerEvent&, const TriggerEvent&) = default;
};

/// A stored window of samples with everything needed to reduce it again. The only thing that
/// crosses from the live side and from replay into processing. All channels have the same number of
/// samples.
struct Shot {
  std::string id;
  Bench bench;
  std::string bench_toml;             ///< the text the bench was read from
  std::optional<Material> bar_model;  ///< the one in force at the shot, if any was set
  ReductionRequest reduction;         ///< in force at the shot: how it is reduced unless told
  SampleRate rate;
  Tick first_tick = 0;                  ///< tick of sample 0
  std::optional<TriggerEvent> trigger;  ///< none for an imported table
  std::vector<ChannelRecord> channels;  ///< in the order of bench.gauges
  std::vector<Gap> gaps;
  std::map<std::string, std::string> meta;  ///< per-shot facts: striker speed, specimen id, ...
  std::int64_t utc_ns = 0;                  ///< of the trigger (live) or of the import
  std::int64_t monotonic_ns = 0;
  std::string software_version;

  [[nodiscard]] std::size_t samples() const noexcept {
    return channels.empty() ? 0 : channels.front().codes.size();
  }
};

/// Leaves out what lies later than so long after a record's first sample: samples, and gaps in
/// them.
/// @param until_s  above 0; a record that ends sooner stays whole
void cut_at(Shot& shot, double until_s);

/// Indices of the samples of a channel at or beyond the converter's ends.
[[nodiscard]] std::vector<std::size_t> clipped_samples(const ChannelRecord& channel);

}  // namespace kolsky
