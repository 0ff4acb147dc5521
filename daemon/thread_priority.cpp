#include "daemon/thread_priority.hpp"

#include <pthread.h>
#include <sched.h>

namespace kolsky {

bool run_in_real_time(const char* name, RealTime priority) noexcept {
  name_thread(name);
  sched_param parameters{};
  parameters.sched_priority = static_cast<int>(priority);
  return pthread_setschedparam(pthread_self(), SCHED_FIFO, &parameters) == 0;
}

void name_thread(const char* name) noexcept {
  pthread_setname_np(pthread_self(), name);
}

}  // namespace kolsky
