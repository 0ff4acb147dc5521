#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>

namespace kolsky {

/// Sees losses where a device neither counts nor flags them: the samples delivered fall behind the
/// monotonic clock and stay behind. What counts is the least delay in each second, since late
/// deliveries only ever add to it; a backlog that is still being worked off is waited for. A clock
/// that is off by less than 200 ppm is no loss. An estimate: it sees a loss of more than
/// `threshold_s`, one to three seconds late, and cannot say where it was.
class LossByClock {
 public:
  LossByClock(double rate_Hz, std::size_t block_samples);

  /// So many more samples were in hand at that time. @return whether samples were lost a while ago
  bool note(std::size_t samples, std::int64_t monotonic_ns);

  [[nodiscard]] double threshold_s() const noexcept { return threshold_s_; }

 private:
  static constexpr double kNever = std::numeric_limits<double>::infinity();

  [[nodiscard]] bool judge_window(double length_s);
  void open_window(double now_s);

  double rate_Hz_;
  double threshold_s_;
  double samples_ = 0.0;
  std::int64_t origin_ns_ = 0;
  bool started_ = false;
  double window_start_s_ = 0.0;
  double least_early_s_ = kNever;  ///< in the window's first half
  double least_late_s_ = kNever;   ///< in its second half
  double baseline_s_ = kNever;
};

}  // namespace kolsky
