#include "daemon/shots/reducing_thread.hpp"

#include <utility>

#include "daemon/shots/summary.hpp"
#include "daemon/thread_priority.hpp"

namespace kolsky {

ReducingThread::ReducingThread() : thread_("kolsky-reduce", [this] { run(); }) {}

ReducingThread::~ReducingThread() {
  ends_.store(true);
  begun_.release();
  thread_.join();
}

Reduction ReducingThread::rehearse(const Shot& shot) {
  const std::lock_guard lock(reducer_mutex_);
  return reduce_as_filed(reducer_, shot);
}

void ReducingThread::begin(std::shared_ptr<const Shot> shot) {
  shot_ = std::move(shot);
  waits_.store(true);
  begun_.release();
}

Reduction ReducingThread::finish() {
  if (!reduce_if_it_waits()) {
    finished_.acquire();
  }
  shot_.reset();
  return std::move(reduction_);
}

bool ReducingThread::reduce_if_it_waits() {
  if (!waits_.exchange(false)) {
    return false;
  }
  const std::lock_guard lock(reducer_mutex_);
  reduction_ = reduce_or_say_why(reducer_, *shot_);
  return true;
}

void ReducingThread::run() {
  run_ahead_of_usual();
  for (begun_.acquire(); !ends_.load(); begun_.acquire()) {
    if (reduce_if_it_waits()) {
      finished_.release();
    }
  }
}

}  // namespace kolsky
