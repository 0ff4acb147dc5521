#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "drivers/simulated/code_source.hpp"
#include "drivers/simulated/iiod_command.hpp"
#include "drivers/simulated/kernel_buffers.hpp"
#include "processing/base/time.hpp"

namespace kolsky {

/// What one voltage channel of the simulated converter tells its client:
/// volts = (code + offset_codes) * scale_mV / 1000, strain = (code + offset_codes) * strain_scale.
struct AdcChannel {
  std::string label;  ///< the gauge's name
  double scale_mV = 1.0;
  double offset_codes = 0.0;
  double strain_scale = 1.0;
};

/// The simulated converter as its IIO attributes show it.
struct AdcSettings {
  int bits = 16;  ///< 12 to 24; up to 16 travel in 16 bits, the rest in 32
  std::vector<AdcChannel> channels;
  bool counter = true;  ///< scan channel count0: the running sample number, modulo 2^32
  std::vector<SampleRate> rates{{1'000'000, 1}};
  SampleRate rate{1'000'000, 1};
  double speed = 1.0;  ///< factor on real time; 0: as fast as the client reads
  double period_s =
      0.0;  ///< a shot each so many seconds of the converter's time; 0: on demand only
  std::string scenario;
  std::uint64_t seed = 0;
};

/// What an attribute answers: its text, or a negative errno.
struct AttributeReply {
  int error = 0;
  std::string text;
};

class AdcStream;

/// The one IIO device that the server shows: attributes, the converter's clock, its shots, and at
/// most one stream. Calls from any thread.
class SimulatedAdc {
 public:
  using Clock = std::chrono::steady_clock;

  /// @throws InputError where the settings contradict themselves
  SimulatedAdc(AdcSettings settings, std::unique_ptr<CodeSource> source);

  [[nodiscard]] const AdcSettings& settings() const noexcept { return settings_; }

  /// The IIO context as libiio's XML, with its DTD.
  [[nodiscard]] std::string context_xml() const;

  [[nodiscard]] bool is_device(const std::string& id) const;
  [[nodiscard]] AttributeReply read_attribute(const IiodCommand& command,
                                              std::uint32_t register_address);
  /// @param register_address  what the connection's later reads of direct_reg_access mean; set here
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

 private:
  friend class AdcStream;

  [[nodiscard]] std::size_t scan_elements() const noexcept;
  [[nodiscard]] Tick now_tick() const;
  [[nodiscard]] Clock::time_point time_of(Tick tick) const;
  [[nodiscard]] double ticks_per_s() const noexcept;
  void restart_clock(Tick at);
  void fire_due_shots(Tick until);
  void start_shot(Tick tick);
  [[nodiscard]] Tick period_ticks() const;
  void note_overrun();
  void note_lost(Tick samples);

  [[nodiscard]] AttributeReply read_device_attribute(const std::string& name);
  [[nodiscard]] AttributeReply read_channel_attribute(const std::string& id,
                                                      const std::string& name);
  int write_device_attribute(const std::string& name, const std::string& value);
  int write_register(const std::string& value, std::uint32_t& register_address);
  int fire_now();
  int set_rate(const std::string& value);

  AdcSettings settings_;
  std::unique_ptr<CodeSource> source_;

  std::mutex mutex_;  ///< guards all below, and source_
  Clock::time_point clock_start_;
  Tick clock_start_tick_ = 0;
  Tick planned_until_ = 0;  ///< ticks before this are spoken for: a shot cannot start there
  Tick shot_ends_ = 0;
  Tick next_periodic_shot_ = 0;
  std::uint64_t shots_fired_ = 0;
  std::uint64_t overrun_lost_samples_ = 0;
  std::uint32_t status_register_ = 0;
  int buffers_count_ = 4;
  std::chrono::milliseconds timeout_{1000};
  AdcStream* stream_ = nullptr;
};

/// A client's open buffer. One thread reads; it ends with its destruction.
class AdcStream {
 public:
  AdcStream(SimulatedAdc& adc, std::vector<std::uint32_t> mask, Tick block_samples);
  ~AdcStream();
  AdcStream(const AdcStream&) = delete;
  AdcStream& operator=(const AdcStream&) = delete;

  /// The channels in each scan.
  [[nodiscard]] const std::vector<std::uint32_t>& mask() const noexcept { return mask_; }
  [[nodiscard]] std::size_t scan_bytes() const noexcept { return scan_bytes_; }

  /// When the block in progress is complete; in the past if it already is.
  [[nodiscard]] SimulatedAdc::Clock::time_point due();

  /// How many samples of the complete block are still to be read. @pre due() is past
  [[nodiscard]] std::size_t available() const noexcept;

  /// Writes the next scans of the block; out.size() is a multiple of scan_bytes(), at most what is
  /// available. With the last of them the client gives the buffer back.
  void read(std::span<std::byte> out);

 private:
  friend class SimulatedAdc;

  /// Where an enabled element stands in a scan.
  struct Element {
    std::size_t channel = 0;
    std::size_t offset = 0;
    std::size_t bytes = 0;
    bool counter = false;
  };

  void lay_out_scan();
  void plan_block();
  void read_run(Tick first, std::span<std::byte> out);

  SimulatedAdc& adc_;
  std::vector<std::uint32_t> mask_;
  Tick block_samples_;
  std::vector<Element> elements_;
  std::size_t scan_bytes_ = 0;
  KernelBuffers buffers_;
  bool planned_ = false;
  Tick block_end_ = 0;
  Tick position_ = 0;  ///< the next tick to be read
  std::vector<std::int32_t> codes_;
};

}  // namespace kolsky
