#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "drivers/digitiser/digitiser.hpp"
#include "drivers/digitiser/open.hpp"
#include "drivers/iio/iio_session.hpp"
#include "drivers/iio/loss_by_clock.hpp"
#include "drivers/iio/refill_watchdog.hpp"
#include "drivers/iio/sample_counter.hpp"
#include "drivers/iio/stream_clock.hpp"

namespace kolsky {

/// Any digitiser that libiio reaches. Lost samples are known to the sample where the device numbers
/// them (a scan channel of type "count"); else its overflow register says that there were some, in
/// one of the blocks that were queued then, each of which is marked; else the clock says so, late.
/// Its own code allocates nothing in `read`; libiio itself takes and frees a few bytes from malloc
/// in each network refill.
class IioDigitiser final : public Digitiser {
 public:
  /// @throws InputError with the URI as its place, within about six seconds
  IioDigitiser(std::string uri, DigitiserOptions options);
  ~IioDigitiser() override;

  [[nodiscard]] const StreamInfo& info() const override { return info_; }
  void start() override;
  ReadStatus read(Block& block) override;
  void cancel() override;
  bool reconnect() override;
  void fire() override;

 private:
  using Session = std::shared_ptr<IioSession>;

  [[nodiscard]] Session open_session(bool started) const;
  void adopt(Session session);
  void drop_session();
  void cancel_refill();

  ReadStatus refill();
  [[nodiscard]] OverflowRegister::Answer poll_overflow();
  ReadStatus classify(ssize_t result);
  ReadStatus take_scans();
  void look_at_run();
  void count_run();
  void deliver(Block& block);

  std::string uri_;
  DigitiserOptions options_;
  std::atomic<bool> cancelled_{false};
  Session prepared_;  ///< opened, not started
  StreamInfo info_;
  std::atomic<bool> simulated_;  ///< of `info_`, for threads that do not read

  std::mutex session_mutex_;  ///< the reading thread changes `session_`, the watchdog and cancel
                              ///< look at it
  Session session_;

  // What the reading thread knows of the stream.
  Tick next_tick_ = 0;
  std::optional<StreamClock> clock_;
  std::optional<SampleCounter> counter_;
  std::optional<LossByClock> loss_by_clock_;
  bool perhaps_missing_ = false;  ///< before the next block
  unsigned int blocks_since_poll_ = 0;
  unsigned int suspect_blocks_ = 0;  ///< each of the next ones may have a hole before it
  bool announced_ = true;            ///< the hole before the next block is no news

  // The last refill, and the run without a hole in it that comes next.
  std::vector<std::vector<std::byte>> codes_;
  IioSession::Scans scans_;
  std::int64_t refill_ns_ = 0;
  std::size_t run_begin_ = 0;
  std::size_t run_end_ = 0;
  Missing missing_;

  RefillWatchdog watchdog_;
};

}  // namespace kolsky
