#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "drivers/simulated/adc_stream.hpp"
#include "drivers/simulated/code_source.hpp"
#include "drivers/simulated/converter_clock.hpp"
#include "drivers/simulated/fault_script.hpp"
#include "drivers/simulated/iiod_command.hpp"
#include "processing/base/time.hpp"

namespace kolsky {

/// What one voltage channel of the simulated converter tells its client:
/// volts = (code + offset_codes) * scale_mV / 1000, strain = (code + offset_codes) * strain_scale.
struct AdcChannel {
  std::string label;  ///< the gauge's name
  double scale_mV = 1.0;
  double offset_codes = 0.0;
  std::optional<double> strain_scale;  ///< where the whole chain is linear and known
};

/// The simulated converter as its IIO attributes show it.
struct AdcSettings {
  int bits = 16;  ///< 12 to 32; up to 16 travel in 16 bits, the rest in 32
  std::vector<AdcChannel> channels;
  bool counter = true;  ///< scan channel count0: the running sample number, modulo 2^32
  std::vector<SampleRate> rates{{1'000'000, 1}};
  SampleRate rate{1'000'000, 1};
  double speed = 1.0;  ///< factor on real time; 0: as fast as the client reads
  double period_s =
      0.0;  ///< a shot each so many seconds of the converter's time; 0: on demand only
  std::string scenario;
  std::uint64_t seed = 0;
  std::vector<Fault> faults;
  std::function<void(const std::string&)>
      log;  ///< of shots and faults; called under the lock, may be empty
};

/// @throws InputError whose place is the setting
void check(const AdcSettings& settings);

/// What an attribute answers: its text, or a negative errno.
struct AttributeReply {
  int error = 0;
  std::string text;
};

/// The one IIO device that the server shows: attributes, the converter's clock, its shots and
/// faults, and at most one stream. Calls from any thread.
///
/// What a client may rely on when it accounts for samples: with count0 enabled, the count of a
/// sample less that of the one before it, less one, is what is missing between them. Everything
/// that the fault script makes a client miss is in `injected_lost_samples`, what a client missed by
/// its own slowness in `overrun_lost_samples`; either raises the overflow flag, except a gap
/// between two connections.
class SimulatedAdc {
 public:
  using Clock = ConverterClock::Clock;

  /// @throws InputError where the settings contradict themselves
  SimulatedAdc(AdcSettings settings, std::unique_ptr<CodeSource> source);

  [[nodiscard]] const AdcSettings& settings() const noexcept { return settings_; }

  /// The IIO context as libiio's XML, with its DTD.
  [[nodiscard]] std::string context_xml() const;

  [[nodiscard]] bool is_device(const std::string& id) const;

  /// @param register_address  what this connection last chose through direct_reg_access
  [[nodiscard]] AttributeReply read_attribute(const IiodCommand& command,
                                              std::uint32_t register_address);
  /// @return 0 or a negative errno
  int write_attribute(const IiodCommand& command, const std::string& value,
                      std::uint32_t& register_address);

  /// How many kernel buffers the next stream has. @return 0 or a negative errno
  int set_buffers_count(std::uint64_t count);

  /// How long a read of any stream waits for its block; 0: for ever. As in libiio's own server the
  /// last client that says so decides for all.
  void set_timeout(std::chrono::milliseconds timeout);
  [[nodiscard]] Clock::time_point read_deadline();

  /// Opens the stream. @return 0 or a negative errno: EBUSY while there is another
  int open_stream(const std::vector<std::uint32_t>& mask, std::uint64_t block_samples,
                  std::unique_ptr<AdcStream>& stream);

  /// No connection is answered before this moment.
  [[nodiscard]] Clock::time_point silent_until();
  /// Keeps silent for a duration of the converter's time. @param seconds  0: for ever
  void keep_silent(double seconds);

  /// When a pause of so many seconds of the converter's time that starts now is over; `paused`
  /// tells the clock that it is.
  [[nodiscard]] Clock::time_point pause_end(double seconds);
  void paused(double seconds);

 private:
  friend class AdcStream;

  [[nodiscard]] std::vector<std::size_t> element_bytes() const;
  [[nodiscard]] std::int32_t highest_code() const noexcept;

  void fire_due_shots(Tick until);
  void start_shot(Tick tick);
  [[nodiscard]] Tick period_ticks() const;
  int fire_now();
  int set_rate(const std::string& value);

  void raise_overflow() noexcept;
  void note_overrun();
  void note_fault(const FaultQueue::Due& due);
  void skip_faults(Tick until);
  void log(const std::string& text) const;

  [[nodiscard]] AttributeReply read_device_attribute(const std::string& name);
  [[nodiscard]] AttributeReply read_channel_attribute(const std::string& id,
                                                      const std::string& name);
  int write_device_attribute(const std::string& name, const std::string& value);
  int write_register(const std::string& value, std::uint32_t& register_address);

  AdcSettings settings_;
  std::unique_ptr<CodeSource> source_;

  std::mutex mutex_;  ///< guards all below, source_ and the rate in settings_
  ConverterClock clock_;
  FaultQueue faults_;
  Tick shot_ends_ = 0;
  Tick next_periodic_shot_ = 0;
  std::int64_t shots_fired_ = 0;
  std::int64_t overrun_lost_samples_ = 0;
  std::int64_t injected_lost_samples_ = 0;
  std::optional<Tick> fault_gap_from_;  ///< a fault ended the last stream before this tick
  std::uint32_t status_register_ = 0;
  int buffers_count_ = 4;
  std::chrono::milliseconds timeout_{1000};
  Clock::time_point silent_until_ = Clock::time_point::min();
  AdcStream* stream_ = nullptr;
};

}  // namespace kolsky
