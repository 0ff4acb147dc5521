#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "drivers/digitiser/digitiser.hpp"
#include "drivers/digitiser/open.hpp"
#include "drivers/replay/replay_source.hpp"

namespace kolsky {

/// Plays captures again, code by code: at their rate, at a factor of it, or as fast as they are
/// read. Known holes are skipped and counted as a device counts them; a stored trigger is the
/// block's mark. A slow reader loses nothing, the replay is late then.
///
/// `read` waits for its time and opens the next capture where one ends, which reads a file and
/// allocates; it does neither within a capture. A capture that can then not be read is a
/// disconnected device; `reconnect` tries it again, and passes over it after `replay_patience`.
class ReplayDigitiser final : public Digitiser {
 public:
  /// @throws InputError with the URI as its place
  ReplayDigitiser(const std::string& uri, const std::filesystem::path& path,
                  const DigitiserOptions& options);

  [[nodiscard]] const StreamInfo& info() const override { return info_; }
  void start() override;
  ReadStatus read(Block& block) override;
  void cancel() override;
  bool reconnect() override;
  void fire() override;

 private:
  bool open_next_capture();
  void wait_for_capture(const std::string& why);
  [[nodiscard]] bool pass_over_after_long(const std::string& why);
  [[nodiscard]] bool capture_done() const noexcept;
  void skip_gaps();
  [[nodiscard]] std::size_t run_end() const noexcept;
  ReadStatus wait_for(Tick end);
  void deliver(Block& block);
  void copy_codes(std::size_t channel, std::size_t samples);

  double speed_;
  std::chrono::milliseconds patience_;
  std::function<void(const std::string&)> tell_;
  ReplaySource source_;
  StreamInfo info_;
  std::vector<std::vector<std::byte>> codes_;

  // Where the replay is.
  std::optional<Shot> shot_;
  std::size_t next_capture_ = 0;
  Tick capture_start_ = 0;  ///< stream tick of the capture's sample 0
  std::size_t position_ = 0;
  std::size_t next_gap_ = 0;
  bool capture_begins_ = false;
  bool marked_ = false;
  Missing missing_;
  std::int64_t start_ns_ = 0;
  std::optional<std::int64_t> unreadable_since_ns_;  ///< the next capture

  std::mutex mutex_;  ///< guards `cancelled_` against the wait
  std::condition_variable cancel_called_;
  bool cancelled_ = false;
};

}  // namespace kolsky
