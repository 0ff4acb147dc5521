#include "daemon/thread_priority.hpp"

#include <sched.h>
#include <sys/resource.h>
#include <unistd.h>

#include <ctime>

#include "daemon/clock.hpp"

namespace kolsky {

bool run_in_real_time(RealTime priority) noexcept {
  sched_param parameters{};
  parameters.sched_priority = static_cast<int>(priority);
  return sched_setscheduler(0, SCHED_FIFO | SCHED_RESET_ON_FORK, &parameters) == 0;
}

bool run_as_usual() noexcept {
  const sched_param parameters{};
  // Who may not set priorities may give one up, but not take the reset off again.
  return sched_setscheduler(0, SCHED_OTHER | SCHED_RESET_ON_FORK, &parameters) == 0;
}

void run_ahead_of_usual() noexcept {
  constexpr int kNice = -15;
  setpriority(PRIO_PROCESS, static_cast<id_t>(gettid()), kNice);
}

bool IdleCheck::rests() noexcept {
  constexpr std::int64_t kLook_ns = 1'000'000'000;
  constexpr double kMostShare = 0.75;
  const std::int64_t now_ns = monotonic_ns();
  if (now_ns - looked_ns_ < kLook_ns) {
    return true;
  }
  const std::int64_t work_ns = clock_ns(CLOCK_THREAD_CPUTIME_ID);
  const bool first = looked_ns_ == 0;
  const double share =
      static_cast<double>(work_ns - worked_ns_) / static_cast<double>(now_ns - looked_ns_);
  looked_ns_ = now_ns;
  worked_ns_ = work_ns;
  return first || share < kMostShare;
}

}  // namespace kolsky
