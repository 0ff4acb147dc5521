#include "daemon/thread_priority.hpp"

#include <gtest/gtest.h>
#include <linux/capability.h>
#include <sched.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <thread>

namespace kolsky {
namespace {

/// From then on the calling thread may do what any user's may.
void drop_privileges() {
  __user_cap_header_struct header{.version = _LINUX_CAPABILITY_VERSION_3, .pid = 0};
  __user_cap_data_struct none[2]{};
  ASSERT_EQ(syscall(SYS_capset, &header, none), 0);
}

int policy() {
  return sched_getscheduler(0) & ~SCHED_RESET_ON_FORK;
}

TEST(ThreadPriority, IsGivenUpByAThreadThatMayNotSetOne) {
  bool permitted = false;
  bool given_up = false;
  int after = SCHED_FIFO;
  std::thread([&] {
    permitted = run_in_real_time(RealTime::recording);
    drop_privileges();
    given_up = run_as_usual();
    after = policy();
  }).join();
  if (!permitted) {
    GTEST_SKIP() << "real-time scheduling is not permitted here";
  }
  EXPECT_TRUE(given_up);
  EXPECT_EQ(after, SCHED_OTHER);
}

}  // namespace
}  // namespace kolsky
