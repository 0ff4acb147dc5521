#pragma once

#include <cstdint>
#include <iosfwd>
#include <optional>
#include <string>
#include <vector>

#include "processing/base/time.hpp"

namespace kolsky {

enum class FaultKind {
  short_block,    ///< the reply ends after so many samples; the rest comes with the next
  late_block,     ///< the block is sent so much later
  timeout,        ///< the read is answered with ETIMEDOUT; the block comes with the next
  hang,           ///< no connection is answered for so long, or for ever
  drop,           ///< every connection is closed, and new ones for so long
  lose,           ///< so many samples are never delivered, and the overflow flag rises
  extra_channel,  ///< the reply holds a scan element that was not asked for
  overflow,       ///< the overflow flag rises and nothing is lost
  clip,           ///< so many samples of every channel stand at the converter's upper end
};

[[nodiscard]] const char* fault_name(FaultKind kind);

/// A fault and when: at a sample of a shot, or at a time of the converter. It acts on the block
/// that holds the sample of that moment, when a client reads that block.
struct Fault {
  FaultKind kind = FaultKind::overflow;
  std::int64_t shot = 0;       ///< 1 is the first; 0: `time_s` says when
  std::int64_t at_sample = 0;  ///< of the shot
  double time_s = 0.0;         ///< since the converter's start
  std::int64_t samples = 0;    ///< short_block, lose, clip
  double duration_s = 0.0;     ///< late_block, hang, drop; 0: a hang without end
};

/// Reads a script: one fault a line, blank lines and `#` to the line's end skipped.
///   (shot N at SAMPLE | time DURATION) KIND
///   KIND: short SAMPLES | late DURATION | timeout | hang [DURATION] | drop DURATION | lose SAMPLES
///   |
///         extra-channel | overflow | clip SAMPLES
///   DURATION: a number with s, ms or us right behind it
/// @param name  stands for the file in messages
/// @throws InputError with the line's number
[[nodiscard]] std::vector<Fault> parse_fault_script(std::istream& script, const std::string& name);

/// The faults of a script with their moments as ticks: those of a shot once it is fired.
class FaultQueue {
 public:
  struct Due {
    Tick tick = 0;
    Fault fault;
  };

  FaultQueue() = default;
  FaultQueue(const std::vector<Fault>& faults, SampleRate rate);

  /// Shot number `shot` begins at `tick`.
  void shot_fired(std::int64_t shot, Tick tick);

  /// Takes the earliest fault before `end`, or nothing.
  [[nodiscard]] std::optional<Due> take_before(Tick end);

 private:
  void insert(Due due);

  std::vector<Fault> of_shots_;
  std::vector<Due> due_;  ///< by tick
};

}  // namespace kolsky
