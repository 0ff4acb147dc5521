#include "daemon/live/thread_watch.hpp"

#include <gtest/gtest.h>

namespace kolsky {
namespace {

using std::chrono::milliseconds;

class ThreadWatchTest : public testing::Test {
 protected:
  ThreadWatchTest() {
    watch_.add("worker", milliseconds(100), [this] {
      return ThreadWatch::Pulse{progress_, has_work_};
    });
  }
  [[nodiscard]] std::string stuck_after(int milliseconds_later) {
    now_ += milliseconds(milliseconds_later);
    return watch_.find_stuck(now_).value_or("");
  }

  ThreadWatch watch_;
  std::uint64_t progress_ = 1;
  bool has_work_ = true;
  std::chrono::steady_clock::time_point now_{};
};

TEST_F(ThreadWatchTest, NamesAThreadThatStandsStillWithWork) {
  EXPECT_EQ(stuck_after(0), "");
  EXPECT_EQ(stuck_after(100), "");
  EXPECT_EQ(stuck_after(1), "worker");
  EXPECT_EQ(stuck_after(1000), "worker");
}

TEST_F(ThreadWatchTest, ForgivesOnceItGetsOn) {
  EXPECT_EQ(stuck_after(0), "");
  EXPECT_EQ(stuck_after(500), "worker");
  ++progress_;
  EXPECT_EQ(stuck_after(10), "");
  EXPECT_EQ(stuck_after(100), "");
}

TEST_F(ThreadWatchTest, LetsAnIdleThreadRest) {
  has_work_ = false;
  EXPECT_EQ(stuck_after(0), "");
  EXPECT_EQ(stuck_after(100'000), "");
  has_work_ = true;
  EXPECT_EQ(stuck_after(50), "");  // counted from when it was last seen idle
}

}  // namespace
}  // namespace kolsky
