#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "processing/base/shot.hpp"
#include "processing/base/time.hpp"

namespace kolsky {

/// Native-endian, sign-extended integers, one type for all channels of a stream.
enum class SampleFormat { int16, int32 };

[[nodiscard]] constexpr std::size_t sample_bytes(SampleFormat format) noexcept {
  return format == SampleFormat::int16 ? 2 : 4;
}

/// What a stream delivers on one channel; value = (code + offset) * scale, as in ChannelRecord.
struct ChannelInfo {
  std::string name;  ///< the digitiser's own name of it
  std::string unit;  ///< "V" or "strain"
  double scale = 1.0;
  double offset = 0.0;
  int bits = 16;
  std::int32_t code_min = -32768;
  std::int32_t code_max = 32767;
};

/// A capture that a replay plays, where it stands in the stream, and what is filed with it.
struct PlayedCapture {
  std::string id;
  Tick first_tick = 0;
  std::size_t samples = 0;
  std::map<std::string, std::string> meta;
  std::string bench_toml;
};

/// What a digitiser is and delivers; fixed from open to close, except where `reconnect` finds it
/// changed.
struct StreamInfo {
  std::string uri;
  std::string description;
  SampleRate rate;
  SampleFormat format = SampleFormat::int16;
  std::vector<ChannelInfo> channels;
  std::size_t max_block_samples = 0;  ///< no block is longer
  bool simulated = false;             ///< `fire` works
  double speed = 1.0;  ///< seconds of the stream per second of the wall clock: not 1 where a
                       ///< simulated one is accelerated, 0 where it waits for its reader
  bool ends = false;   ///< a replay: it comes to an end by itself
  std::vector<PlayedCapture> captures;  ///< of a replay, in their order
};

/// Samples that arrive per second of the wall clock, which is what queues and blocks are sized by;
/// the rate itself where the stream waits for its reader.
[[nodiscard]] inline double arrival_rate_Hz(const StreamInfo& info) {
  return info.rate.Hz() * (info.speed > 0.0 ? info.speed : 1.0);
}

/// What a read came to. Only `samples` fills the block.
enum class ReadStatus {
  samples,
  timeout,   ///< nothing came in time; read again
  overflow,  ///< the digitiser reports that it lost samples; the next block says how many, if known
  disconnected,    ///< the device is gone; `reconnect`
  end_of_capture,  ///< a replay is over; sticky
};

/// What is missing between the end of the last block and the start of this one.
struct Missing {
  enum class Kind { none, known, unknown };
  Kind kind = Kind::none;
  std::int64_t samples = 0;  ///< known: how many; unknown: 0
};

/// A run of samples without a hole. The spans point into the digitiser and hold until its next
/// call.
struct Block {
  Tick first_tick = 0;  ///< of sample 0; known missing samples before it are already counted in
  std::size_t samples = 0;
  Missing missing_before;
  std::int64_t monotonic_ns = 0;  ///< CLOCK_MONOTONIC when the last sample was in hand
  std::vector<std::span<const std::byte>>
      channels;                      ///< per channel: samples x sample_bytes(format)
  std::optional<TriggerEvent> mark;  ///< a trigger that the stream itself carries, in this block
  bool starts_capture = false;       ///< replay: sample 0 is the first of another capture
};

/// A source of samples: hardware through libiio, a stored capture, the simulated digitiser (which
/// is reached through libiio too). One thread calls everything but `cancel`. Nothing here allocates
/// after `start`, apart from `reconnect`.
class Digitiser {
 public:
  virtual ~Digitiser() = default;
  Digitiser() = default;
  Digitiser(const Digitiser&) = delete;
  Digitiser& operator=(const Digitiser&) = delete;

  [[nodiscard]] virtual const StreamInfo& info() const = 0;

  /// Begins the stream. @throws InputError where a setting is refused
  virtual void start() = 0;

  /// Waits for the next block, at most about a second.
  virtual ReadStatus read(Block& block) = 0;

  /// Makes a waiting `read` return soon; from any thread. Sticky: later reads return
  /// `disconnected`.
  virtual void cancel() = 0;

  /// One attempt to open the device again after `disconnected`. Ticks go on; the next block says
  /// what is missing (unknown unless the device counts). @return whether the stream runs again What
  /// came back may be another device under the same name: compare `info` with what it was.
  virtual bool reconnect() = 0;

  /// Asks a simulated digitiser for its pulse. From any thread. @throws InputError on real hardware
  virtual void fire() = 0;
};

}  // namespace kolsky
