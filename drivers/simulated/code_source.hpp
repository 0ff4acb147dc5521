#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "processing/base/time.hpp"

namespace kolsky {

/// What the simulated converter converts: codes of any channel at any tick, and a pulse on demand.
/// Calls come one at a time. The same tick gives the same code however the stream is cut into
/// blocks, unless a shot was fired in between.
class CodeSource {
 public:
  virtual ~CodeSource() = default;
  CodeSource() = default;
  CodeSource(const CodeSource&) = delete;
  CodeSource& operator=(const CodeSource&) = delete;

  /// Codes of the channel at first_tick, first_tick + 1, ...
  virtual void convert(std::size_t channel, Tick first_tick, std::span<std::int32_t> codes) = 0;

  /// Starts a shot: its first sample is that of `tick`. An earlier shot is over.
  virtual void fire(Tick tick) = 0;

  /// How many samples a shot lasts at the present rate.
  [[nodiscard]] virtual Tick shot_samples() const = 0;

  /// From now on ticks are 1/rate apart.
  virtual void set_rate(SampleRate rate) = 0;
};

}  // namespace kolsky
