#include "drivers/iio/iio_digitiser.hpp"

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <utility>

#include "drivers/iio/iio_attributes.hpp"
#include "drivers/iio/iio_uri.hpp"
#include "drivers/iio/late_task.hpp"
#include "drivers/iio/monotonic.hpp"
#include "processing/base/error.hpp"

namespace kolsky {
namespace {

using std::chrono::milliseconds;

/// More than libiio's own five seconds for a connection, so that its reason is heard where it has
/// one.
constexpr milliseconds kLongestSetUp{5500};
/// libiio's own time-outs end a refill after one second; a longer one hangs.
constexpr milliseconds kLongestRefill{2500};

bool fire_once(const std::string& uri, const DigitiserOptions& options) {
  const ContextHandle context = open_context(uri);
  const SigpipeBlocked guard;
  const AttributeOwner device{choose_device(context.get(), options), nullptr};
  const long error = write_text(device, "fire", "1");
  if (error < 0) {
    throw InputError(uri, "does not fire (" + error_text(error) + ")", "try again after the shot");
  }
  return true;
}

InputError too_slow(const std::string& uri) {
  return InputError(uri, "does not answer in time", "check the connection with iio_info -u");
}

}  // namespace

IioDigitiser::IioDigitiser(std::string uri, DigitiserOptions options)
    : uri_(std::move(uri)),
      options_(std::move(options)),
      prepared_(open_session(false)),
      info_(prepared_->info()),
      simulated_(info_.simulated),
      watchdog_(kLongestRefill, [this] { cancel_refill(); }) {}

IioDigitiser::~IioDigitiser() = default;

IioDigitiser::Session IioDigitiser::open_session(bool started) const {
  check_uri(uri_);
  const auto open = [uri = uri_, options = options_, started] {
    auto session = std::make_shared<IioSession>(uri, options);
    if (started) {
      session->start();
    }
    return session;
  };
  const std::optional<Session> session =
      run_within<Session>(kLongestSetUp, open, [this] { return cancelled_.load(); });
  if (!session) {
    throw too_slow(uri_);
  }
  return *session;
}

void IioDigitiser::start() {
  Session session = prepared_ ? std::move(prepared_) : open_session(false);
  clock_.emplace(monotonic_ns(), arrival_rate_Hz(session->info()));
  const auto start_it = [session] {
    session->start();
    return true;
  };
  if (!run_within<bool>(kLongestSetUp, start_it, [this] { return cancelled_.load(); })) {
    throw too_slow(uri_);
  }
  adopt(std::move(session));
}

void IioDigitiser::adopt(Session session) {
  info_ = session->info();
  simulated_ = info_.simulated;
  codes_.assign(info_.channels.size(),
                std::vector<std::byte>(info_.max_block_samples * sample_bytes(info_.format)));
  if (!session->counter()) {
    counter_.reset();
  } else if (!counter_) {
    counter_.emplace(*session->counter());
  }
  loss_by_clock_.reset();
  const bool has_pace = info_.speed > 0.0;
  if (!session->counter() && session->overflow_register() == nullptr && has_pace) {
    loss_by_clock_.emplace(arrival_rate_Hz(info_), info_.max_block_samples);
  }
  scans_ = {};
  run_begin_ = 0;
  const std::lock_guard lock(session_mutex_);
  session_ = std::move(session);
}

void IioDigitiser::drop_session() {
  scans_ = {};
  run_begin_ = 0;
  Session gone;
  const std::lock_guard lock(session_mutex_);
  gone.swap(session_);
}

void IioDigitiser::cancel_refill() {
  const std::lock_guard lock(session_mutex_);
  if (session_) {
    session_->cancel();
  }
}

void IioDigitiser::cancel() {
  cancelled_ = true;
  cancel_refill();
}

bool IioDigitiser::reconnect() {
  if (cancelled_) {
    return false;
  }
  drop_session();
  Session session;
  try {
    session = open_session(true);
  } catch (const InputError&) {
    return false;  // nothing answers, or not yet what was asked for
  }
  adopt(std::move(session));
  perhaps_missing_ = true;
  suspect_blocks_ = 0;
  announced_ = true;
  return !cancelled_;
}

void IioDigitiser::fire() {
  if (!simulated_) {
    throw InputError(uri_, "is no simulated digitiser, so nothing can be fired",
                     "use force-trigger, or fire the gun by hand");
  }
  const auto fire_it = [uri = uri_, options = options_] { return fire_once(uri, options); };
  if (!run_within<bool>(kLongestSetUp, fire_it, [this] { return cancelled_.load(); })) {
    throw too_slow(uri_);
  }
}

ReadStatus IioDigitiser::read(Block& block) {
  if (cancelled_ || !session_) {
    return ReadStatus::disconnected;
  }
  if (run_begin_ == scans_.count) {
    const ReadStatus status = refill();
    if (status != ReadStatus::samples) {
      return status;
    }
  }
  if (!announced_) {
    announced_ = true;
    return ReadStatus::overflow;
  }
  deliver(block);
  return ReadStatus::samples;
}

ReadStatus IioDigitiser::refill() {
  watchdog_.begin();
  const ssize_t bytes = session_->refill();
  watchdog_.end();
  if (bytes <= 0) {
    return classify(bytes);
  }
  refill_ns_ = monotonic_ns();
  return take_scans();
}

/// What is lost when the queue is full is missing behind the queue, a whole queue after the flag;
/// what is lost on the way to it is missing in what was just read. With a poll at least every half
/// queue the first kind cannot have passed unseen.
OverflowRegister::Answer IioDigitiser::poll_overflow() {
  OverflowRegister* flag = session_->overflow_register();
  if (flag == nullptr) {
    return OverflowRegister::Answer::not_due;
  }
  const bool half_a_queue = ++blocks_since_poll_ > session_->kernel_buffers() / 2;
  const SigpipeBlocked guard;
  const OverflowRegister::Answer answer = flag->poll(monotonic_ns(), half_a_queue);
  if (answer != OverflowRegister::Answer::not_due) {
    blocks_since_poll_ = 0;
  }
  if (answer == OverflowRegister::Answer::overflow) {
    suspect_blocks_ = session_->kernel_buffers() + 1;
    announced_ = false;
  }
  return answer;
}

ReadStatus IioDigitiser::classify(ssize_t result) {
  switch (result) {
    case 0:
      return ReadStatus::timeout;
    case -ETIMEDOUT:
    case -EAGAIN:
    case -EINTR:
      // A local read that times out, here or behind the server, forgets what it had already read.
      perhaps_missing_ = true;
      return ReadStatus::timeout;
    default:
      // -EPIPE also after a stalled network, and the stream is then out of step; -EBADF after the
      // watchdog's cancel; -ENODEV and -EIO when the device has gone.
      drop_session();
      return ReadStatus::disconnected;
  }
}

ReadStatus IioDigitiser::take_scans() {
  scans_ = session_->scans();
  if (!scans_.whole || scans_.count > info_.max_block_samples) {
    drop_session();
    return ReadStatus::disconnected;
  }
  if (scans_.count == 0) {
    return ReadStatus::timeout;
  }
  for (std::size_t i = 0; i < codes_.size(); ++i) {
    session_->decode(i, scans_, codes_[i].data());
  }
  run_begin_ = 0;
  if (poll_overflow() == OverflowRegister::Answer::failed) {
    drop_session();
    return ReadStatus::disconnected;
  }
  look_at_run();
  if (loss_by_clock_ && loss_by_clock_->note(scans_.count, refill_ns_)) {
    missing_.kind = Missing::Kind::unknown;
    announced_ = false;
  }
  return ReadStatus::samples;
}

void IioDigitiser::look_at_run() {
  missing_ = {};
  run_end_ = scans_.count;
  if (counter_) {
    count_run();
  } else if (perhaps_missing_ || suspect_blocks_ > 0) {
    missing_.kind = Missing::Kind::unknown;
  }
  perhaps_missing_ = false;
  suspect_blocks_ -= suspect_blocks_ > 0 ? 1 : 0;
}

void IioDigitiser::count_run() {
  const auto at = [&](std::size_t i) {
    return session_->counter_values() + scans_.stride * static_cast<std::ptrdiff_t>(i);
  };
  const Tick possible = clock_->possible_ticks(refill_ns_) - next_tick_;
  const std::optional<Tick> missing = counter_->missing_before(at(run_begin_), possible);
  if (!missing) {
    missing_.kind = Missing::Kind::unknown;
  } else if (*missing > 0) {
    missing_ = {Missing::Kind::known, *missing};
  }
  run_end_ =
      run_begin_ + counter_->run_length(at(run_begin_), scans_.stride, scans_.count - run_begin_);
  counter_->note(at(run_end_ - 1));
  announced_ = missing_.kind == Missing::Kind::none || perhaps_missing_;
}

void IioDigitiser::deliver(Block& block) {
  const std::size_t bytes = sample_bytes(info_.format);
  const std::size_t samples = run_end_ - run_begin_;
  next_tick_ += missing_.samples;
  block.first_tick = next_tick_;
  block.samples = samples;
  block.missing_before = missing_;
  block.monotonic_ns = refill_ns_;
  block.mark.reset();
  block.starts_capture = false;
  block.channels.resize(codes_.size());
  for (std::size_t i = 0; i < codes_.size(); ++i) {
    block.channels[i] = {codes_[i].data() + run_begin_ * bytes, samples * bytes};
  }
  next_tick_ += static_cast<Tick>(samples);
  clock_->note(next_tick_, refill_ns_);
  run_begin_ = run_end_;
  if (run_begin_ < scans_.count) {
    look_at_run();
  }
}

}  // namespace kolsky
