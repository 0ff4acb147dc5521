#include "daemon/critic/shot_critic.hpp"

#include <fmt/format.h>

#include "daemon/clock.hpp"
#include "daemon/critic/shot_comparison.hpp"
#include "daemon/log.hpp"
#include "kolsky/v1/kolsky.pb.h"
#include "proto/light.hpp"

namespace kolsky {

ShotCritic::ShotCritic(Publisher& publisher) : publisher_(publisher) {}

ShotCritic::~ShotCritic() {
  stop();
}

void ShotCritic::start() {
  thread_ = Thread("kolsky-compare", [this] { run(); });
}

void ShotCritic::stop() {
  {
    const std::lock_guard lock(mutex_);
    stop_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

void ShotCritic::change(std::shared_ptr<const ActiveModel> model) {
  const std::lock_guard lock(mutex_);
  model_ = std::move(model);
  trend_.clear();
  last_.reset();
}

void ShotCritic::compare(std::shared_ptr<const Shot> shot) {
  std::shared_ptr<const Shot> left_out;
  {
    const std::lock_guard lock(mutex_);
    if (!model_) {
      return;
    }
    if (waiting_.size() >= kMostWaiting) {
      left_out = std::move(waiting_.front());
      waiting_.pop_front();
    }
    waiting_.push_back(std::move(shot));
  }
  changed_.notify_all();
  if (left_out) {
    v1::Fault fault;
    fault.set_kind("comparison");
    fault.set_text("shot " + left_out->id + " was not compared: shots come faster than that");
    log::warning(fault.text());
    publisher_.publish_fault(fault);
  }
}

std::shared_ptr<const ActiveModel> ShotCritic::model() const {
  const std::lock_guard lock(mutex_);
  return model_;
}

bool ShotCritic::last(v1::Comparison& comparison) const {
  const std::lock_guard lock(mutex_);
  if (!last_) {
    return false;
  }
  comparison = *last_;
  return true;
}

bool ShotCritic::idle() const {
  const std::lock_guard lock(mutex_);
  return waiting_.empty() && !busy_;
}

void ShotCritic::run() {
  std::unique_lock lock(mutex_);
  for (;;) {
    changed_.wait(lock, [&] { return stop_ || !waiting_.empty(); });
    if (waiting_.empty()) {
      return;
    }
    const std::shared_ptr<const Shot> shot = std::move(waiting_.front());
    waiting_.pop_front();
    busy_ = true;
    lock.unlock();
    compare_now(*shot);
    lock.lock();
    busy_ = false;
  }
}

void ShotCritic::compare_now(const Shot& shot) {
  const std::shared_ptr<const ActiveModel> used = model();
  if (!used) {
    return;
  }
  v1::Comparison message;
  const std::int64_t start_ns = monotonic_ns();
  try {
    compare_with_model(shot, *used, message);
  } catch (const std::exception& error) {
    message.set_reason(error.what());
  }
  message.set_duration_s(static_cast<double>(monotonic_ns() - start_ns) * 1e-9);
  {
    const std::lock_guard lock(mutex_);
    if (model_ != used) {
      return;  // of a model that is no longer asked for
    }
    if (message.comparable()) {
      trend_.push_back(message.misfit().chi2_reduced());
      if (trend_.size() > kTrend) {
        trend_.pop_front();
      }
    }
    message.mutable_trend()->Add(trend_.begin(), trend_.end());
    last_ = std::make_unique<v1::Comparison>(message);
  }
  publisher_.publish_comparison(message);
  log::info(message.comparable()
                ? fmt::format("shot {}: {} beside {}, chi2/N {:.3g}", shot.id,
                              wire::name_of(message.light()), message.model_path(),
                              message.misfit().chi2_reduced())
                : fmt::format("shot {}: not compared: {}", shot.id, message.reason()));
}

}  // namespace kolsky
