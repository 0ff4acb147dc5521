#include "daemon/thread.hpp"

#include <pthread.h>

#include <cstdlib>
#include <exception>
#include <string>
#include <utility>

#include "daemon/log.hpp"

namespace kolsky {

namespace {

/// Without destructors, which would wait for a thread that is no more.
[[noreturn]] void end_process(const char* name, const std::exception& error) {
  log::error(std::string(name) + ": " + error.what() + "; ending, a defect of this program");
  log::stop();
  std::_Exit(EXIT_FAILURE);
}

}  // namespace

Thread::Thread(const char* name, std::function<void()> work)
    : thread_([name, work = std::move(work)] {
        pthread_setname_np(pthread_self(), name);
        try {
          work();
        } catch (const std::exception& error) {
          end_process(name, error);
        }
      }) {}

void Thread::join() {
  if (thread_.joinable()) {
    thread_.join();
  }
}

}  // namespace kolsky
