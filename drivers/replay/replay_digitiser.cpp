#include "drivers/replay/replay_digitiser.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstring>
#include <utility>

#include "processing/base/error.hpp"

namespace kolsky {
namespace {

using Clock = std::chrono::steady_clock;  // CLOCK_MONOTONIC

constexpr std::chrono::seconds kLongestWait{1};

std::int64_t now_ns() {
  return std::chrono::nanoseconds(Clock::now().time_since_epoch()).count();
}

double checked_speed(const std::string& uri, double speed) {
  if (!(speed >= 0.0) || !std::isfinite(speed)) {
    throw InputError(uri, "a replay speed of " + std::to_string(speed),
                     "give a factor on the real rate, or 0 for as fast as possible");
  }
  return speed;
}

ReplaySource open_source(const std::string& uri, const std::filesystem::path& path,
                         const DigitiserOptions& options) {
  if (path.empty()) {
    throw InputError(uri, "names no capture", "give replay:CAPTURE.h5 or replay:FOLDER");
  }
  try {
    return {path, options};
  } catch (const InputError& error) {
    throw error.inside(uri);
  }
}

StreamInfo describe(const std::string& uri, const ReplaySource& source,
                    const DigitiserOptions& options) {
  StreamInfo info;
  info.uri = uri;
  info.description = "replay of " + std::to_string(source.captures().size()) + " captures, " +
                     std::to_string(source.total_samples()) + " samples";
  info.rate = source.rate();
  info.channels = source.channels();
  const auto narrow_channel = [](const ChannelInfo& channel) {
    return channel.bits <= 16 && channel.code_min >= INT16_MIN && channel.code_max <= INT16_MAX;
  };
  const bool narrow = std::all_of(info.channels.begin(), info.channels.end(), narrow_channel);
  info.format = narrow ? SampleFormat::int16 : SampleFormat::int32;
  info.speed = options.replay_speed;
  const std::size_t least = default_block(info.rate.Hz());
  info.max_block_samples = options.block_samples != 0 ? options.block_samples : least;
  info.ends = true;
  info.captures = source.captures();
  return info;
}

}  // namespace

ReplayDigitiser::ReplayDigitiser(const std::string& uri, const std::filesystem::path& path,
                                 const DigitiserOptions& options)
    : speed_(checked_speed(uri, options.replay_speed)),
      patience_(options.replay_patience),
      tell_(options.tell),
      source_(open_source(uri, path, options)),
      info_(describe(uri, source_, options)),
      codes_(info_.channels.size(),
             std::vector<std::byte>(info_.max_block_samples * sample_bytes(info_.format))) {}

void ReplayDigitiser::start() {
  try {
    open_next_capture();
  } catch (const InputError& error) {
    throw error.inside(info_.uri);
  }
  start_ns_ = now_ns();
}

/// @return false after the last one @throws InputError
bool ReplayDigitiser::open_next_capture() {
  if (next_capture_ == source_.captures().size()) {
    return false;
  }
  Shot next = source_.load(next_capture_);
  capture_start_ = source_.captures()[next_capture_].first_tick;
  unreadable_since_ns_.reset();
  missing_ = {};
  if (next_capture_ > 0) {
    missing_.kind = Missing::Kind::unknown;
  }
  shot_ = std::move(next);
  ++next_capture_;
  position_ = 0;
  next_gap_ = 0;
  capture_begins_ = true;
  marked_ = !shot_->trigger;
  skip_gaps();
  return true;
}

bool ReplayDigitiser::capture_done() const noexcept {
  return !shot_ || position_ == shot_->samples();
}

/// Passes over the holes that begin here, and counts them into what is missing before the next
/// block.
void ReplayDigitiser::skip_gaps() {
  const auto here = [&] { return shot_->first_tick + static_cast<Tick>(position_); };
  for (; next_gap_ < shot_->gaps.size() && shot_->gaps[next_gap_].first_tick <= here();
       ++next_gap_) {
    const Gap& gap = shot_->gaps[next_gap_];
    const Tick skipped = std::max<Tick>(0, gap.first_tick + gap.samples - here());
    position_ += static_cast<std::size_t>(skipped);
    if (!gap.known || missing_.kind == Missing::Kind::unknown) {
      missing_ = {Missing::Kind::unknown, 0};
    } else if (skipped > 0) {
      missing_ = {Missing::Kind::known, missing_.samples + skipped};
    }
  }
}

/// End of the next block: the longest allowed, up to the next hole or the end of the capture.
std::size_t ReplayDigitiser::run_end() const noexcept {
  std::size_t end = std::min(position_ + info_.max_block_samples, shot_->samples());
  if (next_gap_ < shot_->gaps.size()) {
    end = std::min(end,
                   static_cast<std::size_t>(shot_->gaps[next_gap_].first_tick - shot_->first_tick));
  }
  return end;
}

ReadStatus ReplayDigitiser::read(Block& block) {
  {
    const std::lock_guard lock(mutex_);
    if (cancelled_ || next_capture_ == 0) {
      return ReadStatus::disconnected;
    }
  }
  while (capture_done()) {
    try {
      if (!open_next_capture()) {
        return ReadStatus::end_of_capture;
      }
    } catch (const InputError& error) {
      wait_for_capture(error.what());
      return ReadStatus::disconnected;
    }
  }
  const ReadStatus status = wait_for(capture_start_ + static_cast<Tick>(run_end()));
  if (status == ReadStatus::samples) {
    deliver(block);
  }
  return status;
}

/// Until the sample before `end` is due.
ReadStatus ReplayDigitiser::wait_for(Tick end) {
  if (speed_ == 0.0) {
    return ReadStatus::samples;
  }
  const double due_s = static_cast<double>(end) / (info_.rate.Hz() * speed_);
  const double left_s = due_s - static_cast<double>(now_ns() - start_ns_) * 1e-9;
  if (left_s <= 0.0) {
    return ReadStatus::samples;
  }
  const auto left = std::chrono::duration<double>(std::min(left_s, double{kLongestWait.count()}));
  std::unique_lock lock(mutex_);
  if (cancel_called_.wait_for(lock, left, [this] { return cancelled_; })) {
    return ReadStatus::disconnected;
  }
  return left_s > left.count() ? ReadStatus::timeout : ReadStatus::samples;
}

void ReplayDigitiser::deliver(Block& block) {
  const std::size_t end = run_end();
  block.samples = end - position_;
  block.first_tick = capture_start_ + static_cast<Tick>(position_);
  block.missing_before = missing_;
  block.starts_capture = capture_begins_;
  block.mark.reset();
  const Tick rebase = capture_start_ - shot_->first_tick;
  if (!marked_ && shot_->trigger->tick + rebase < capture_start_ + static_cast<Tick>(end)) {
    block.mark = shot_->trigger;
    block.mark->tick += rebase;
    block.mark->kind = TriggerKind::marked;
    marked_ = true;
  }
  block.channels.resize(codes_.size());
  for (std::size_t i = 0; i < codes_.size(); ++i) {
    copy_codes(i, block.samples);
    block.channels[i] = {codes_[i].data(), block.samples * sample_bytes(info_.format)};
  }
  block.monotonic_ns = now_ns();
  position_ = end;
  missing_ = {};
  capture_begins_ = false;
  skip_gaps();
}

void ReplayDigitiser::copy_codes(std::size_t channel, std::size_t samples) {
  const std::int32_t* from = shot_->channels[channel].codes.data() + position_;
  if (info_.format == SampleFormat::int32) {
    std::memcpy(codes_[channel].data(), from, samples * sizeof(std::int32_t));
    return;
  }
  auto* to = reinterpret_cast<std::int16_t*>(codes_[channel].data());
  std::transform(from, from + samples, to,
                 [](std::int32_t code) { return static_cast<std::int16_t>(code); });
}

void ReplayDigitiser::cancel() {
  {
    const std::lock_guard lock(mutex_);
    cancelled_ = true;
  }
  cancel_called_.notify_all();
}

bool ReplayDigitiser::reconnect() {
  {
    const std::lock_guard lock(mutex_);
    if (cancelled_ || next_capture_ == 0) {
      return false;
    }
  }
  try {
    return !capture_done() || open_next_capture();
  } catch (const InputError& error) {
    return pass_over_after_long(error.what());
  }
}

void ReplayDigitiser::wait_for_capture(const std::string& why) {
  if (!unreadable_since_ns_) {
    unreadable_since_ns_ = now_ns();
    tell_(why + " (it is tried again for " + std::to_string(patience_.count()) + " ms)");
  }
}

/// @return whether the replay goes on without it
bool ReplayDigitiser::pass_over_after_long(const std::string& why) {
  wait_for_capture(why);
  if (now_ns() - *unreadable_since_ns_ < std::chrono::nanoseconds(patience_).count()) {
    return false;
  }
  tell_(why + " (it is passed over)");
  unreadable_since_ns_.reset();
  ++next_capture_;
  return true;
}

void ReplayDigitiser::fire() {
  throw InputError(info_.uri, "is a replay, so nothing can be fired",
                   "use the simulated digitiser");
}

}  // namespace kolsky
