#include "daemon/shots/recorder.hpp"

#include <fmt/format.h>

#include <utility>

#include "daemon/clock.hpp"
#include "daemon/log.hpp"
#include "daemon/shots/shot_context.hpp"
#include "daemon/shots/summary.hpp"
#include "daemon/thread_priority.hpp"
#include "kolsky/v1/kolsky.pb.h"
#include "processing/base/error.hpp"
#include "proto/codec.hpp"

namespace kolsky {

/// Messages are kept between shots, with the memory they have grown to.
struct ShotRecorder::Messages {
  v1::Shot shot;
  v1::Result result;
};

/// Names the time since the last lap.
class Stopwatch {
 public:
  explicit Stopwatch(std::int64_t start_ns) : last_ns_(start_ns) { laps_.reserve(8); }

  void lap(const char* stage) {
    const std::int64_t now_ns = monotonic_ns();
    laps_.push_back({stage, static_cast<double>(now_ns - last_ns_) * 1e-9});
    last_ns_ = now_ns;
  }
  [[nodiscard]] const std::vector<StageDuration>& laps() const { return laps_; }

 private:
  std::int64_t last_ns_;
  std::vector<StageDuration> laps_;
};

namespace {

void put_timings(const std::vector<StageDuration>& laps, v1::Result& result) {
  for (const StageDuration& lap : laps) {
    v1::StageTiming& timing = *result.add_timings();
    timing.set_stage(lap.stage);
    timing.set_duration_s(lap.duration_s);
  }
}

std::string gap_text(const Gap& gap) {
  return gap.known
             ? fmt::format("{} samples are missing from tick {} on", gap.samples, gap.first_tick)
             : fmt::format("an unknown number of samples is missing at tick {}", gap.first_tick);
}

}  // namespace

ShotRecorder::ShotRecorder(const Parts& parts, std::shared_ptr<const ShotSettings> settings)
    : parts_(parts),
      ids_(parts.publisher.boot_id()),
      messages_(std::make_unique<Messages>()),
      settings_(std::move(settings)) {}

ShotRecorder::~ShotRecorder() {
  stop();
}

void ShotRecorder::start() {
  rehearse(*settings());
  thread_ = Thread("kolsky-record", [this] { run(); });
}

void ShotRecorder::stop() {
  thread_.join();
}

void ShotRecorder::change(std::shared_ptr<const ShotSettings> settings) {
  rehearse(*settings);
  const std::lock_guard lock(mutex_);
  settings_ = std::move(settings);
}

void ShotRecorder::rehearse(const ShotSettings& settings) {
  if (settings.blank.bench.kind == BenchKind::bar) {
    return;  // nothing is reduced live
  }
  const Shot shot = rehearsal_shot(settings.blank, settings.pre_samples, settings.post_samples);
  v1::Shot shot_message;
  v1::Result result_message;
  wire::encode(shot, "", shot_message);
  wire::encode(reducing_.rehearse(shot), "", result_message);
}

ShotRecorder::Counters ShotRecorder::counters() const noexcept {
  return {.shots_journaled = journaled_.load(),
          .journal_failures = journal_failures_.load(),
          .ring_overruns = overruns_.load(),
          .progress = progress_.load()};
}

std::string ShotRecorder::last_shot_id() const {
  const std::lock_guard lock(mutex_);
  return last_shot_id_;
}

std::vector<StageDuration> ShotRecorder::last_timings() const {
  const std::lock_guard lock(mutex_);
  return last_timings_;
}

std::shared_ptr<const ShotSettings> ShotRecorder::settings() const {
  const std::lock_guard lock(mutex_);
  return settings_;
}

void ShotRecorder::run() {
  bool real_time = parts_.real_time && run_in_real_time(RealTime::recording);
  IdleCheck idle_check;
  AcquisitionEvent event;
  while (parts_.events.pop_wait(event)) {
    busy_.store(true);
    handle(event);
    progress_.fetch_add(1);
    busy_.store(false);
    if (real_time && !idle_check.rests()) {
      real_time = !run_as_usual();
    }
  }
}

void ShotRecorder::handle(const AcquisitionEvent& event) {
  tell_losses_kept_back(event.tick, monotonic_ns());
  switch (event.kind) {
    case AcquisitionEvent::Kind::window:
      record(event.window);
      break;
    case AcquisitionEvent::Kind::gap:
      gaps_.add(event.gap);
      gaps_.forget_before(event.tick - static_cast<Tick>(parts_.ring.capacity_samples()));
      tell_loss(event);
      break;
    case AcquisitionEvent::Kind::triggered:
      log::info(fmt::format("triggered at tick {}", event.tick));
      break;
    case AcquisitionEvent::Kind::reconnected:
      log::info("the digitiser is back");
      break;
    case AcquisitionEvent::Kind::end_of_capture:
      log::info("the replay is over");
      name_captures_without_shot();
      seen_end_.store(true);
      break;
    case AcquisitionEvent::Kind::overflow:
      tell_loss(event);
      break;
    case AcquisitionEvent::Kind::window_refused:
    case AcquisitionEvent::Kind::disconnected:
    case AcquisitionEvent::Kind::changed:
      report_loss(event);
      break;
  }
}

void ShotRecorder::name_captures_without_shot() const {
  std::vector<std::string> silent;
  for (const PlayedCapture& capture : parts_.captures) {
    if (!played_.contains(capture.id)) {
      silent.push_back(capture.id);
    }
  }
  if (!silent.empty()) {
    log::warning(
        fmt::format("no shot came of {} of {} captures, {} first: the trigger saw no pulse",
                    silent.size(), parts_.captures.size(), silent.front()));
  }
}

void ShotRecorder::tell_loss(const AcquisitionEvent& event) {
  const auto samples = static_cast<std::uint64_t>(event.gap.samples);
  if (losses_.tells(monotonic_ns(), samples)) {
    report_loss(event);
  }
}

void ShotRecorder::tell_losses_kept_back(Tick tick, std::int64_t now_ns) {
  if (const auto more = losses_.kept_back(now_ns)) {
    fault("losses",
          fmt::format("{} more losses since, {} samples known to be missing: the stream does not "
                      "keep up",
                      more->losses, more->samples),
          tick, more->samples);
  }
}

void ShotRecorder::report_loss(const AcquisitionEvent& event) {
  using Kind = AcquisitionEvent::Kind;
  switch (event.kind) {
    case Kind::gap:
      fault("gap", gap_text(event.gap), event.gap.first_tick,
            static_cast<std::uint64_t>(event.gap.samples));
      break;
    case Kind::overflow:
      fault("overflow", "the digitiser says that it lost samples", event.tick, 0);
      break;
    case Kind::disconnected:
      fault("disconnected", "the digitiser is gone; trying to reach it again", event.tick, 0);
      break;
    case Kind::changed:
      fault("changed",
            "the digitiser came back with another rate or scale; restart the daemon to take it",
            event.tick, 0);
      break;
    case Kind::window_refused:
      fault("window-refused", "too many windows were open; this trigger has no shot", event.tick,
            0);
      break;
    default:
      break;
  }
}

void ShotRecorder::fault(const char* kind, const std::string& text, Tick tick,
                         std::uint64_t samples) {
  log::warning(text);
  v1::Fault message;
  message.set_kind(kind);
  message.set_text(text);
  message.set_tick(tick);
  message.set_samples(samples);
  parts_.publisher.publish_fault(message);
}

void ShotRecorder::record(const Window& window) {
  Stopwatch watch(window.complete_monotonic_ns);
  watch.lap("hand-over");
  const std::shared_ptr<Shot> shot = cut(window);
  parts_.acquirer.release_window();
  if (!shot) {
    return;
  }
  watch.lap("copy");
  const bool written = journaled(*shot, [&] { parts_.journal.write_shot(*shot); });
  watch.lap("journal");
  // Now that no crash takes the shot it is reduced, while the disk takes it.
  reducing_.begin(shot);
  if (!written || !journaled(*shot, [&] { parts_.journal.make_durable(*shot); })) {
    file_unjournaled(shot);
    return;
  }
  journaled_.fetch_add(1);
  watch.lap("durable");
  parts_.archivist.expect_shot();
  announce(*shot, watch);
  const Reduction reduction = reducing_.finish();
  watch.lap("reduce");
  wire::encode(reduction, shot->id, messages_->result);
  watch.lap("encode");
  put_timings(watch.laps(), messages_->result);
  parts_.publisher.publish_result(messages_->result);
  watch.lap("publish");
  {
    const std::lock_guard lock(mutex_);
    last_shot_id_ = shot->id;
    last_timings_ = watch.laps();
  }
  if (parts_.published) {
    parts_.published(shot);
  }
  const CatalogueEntry entry = summarise(*shot, reduction, "");
  parts_.archivist.store(shot, entry);
  log::info(fmt::format("shot {}: {}{}", shot->id, entry.verdict,
                        entry.reducible ? "" : ", not reducible: " + entry.reason));
}

std::shared_ptr<Shot> ShotRecorder::cut(const Window& whole) {
  const Window window = gaps_.without_holes_at_ends(whole);
  auto shot = std::make_shared<Shot>(settings()->blank);
  const SampleRing::CopyStatus status = cut_window(parts_.ring, window, *shot);
  if (status != SampleRing::CopyStatus::copied) {
    overruns_.fetch_add(1);
    fault("ring-overrun", "the recorder came too late; the window of this trigger is lost",
          window.trigger.tick, static_cast<std::uint64_t>(window.end_tick - window.first_tick));
    return nullptr;
  }
  shot->gaps = gaps_.within(window.first_tick, window.end_tick);
  gaps_.forget_before(window.end_tick - static_cast<Tick>(parts_.ring.capacity_samples()));
  if (window.end == WindowEnd::interrupted) {
    mark_interrupted(*shot);
  }
  shot->monotonic_ns = window.trigger_monotonic_ns;
  shot->utc_ns = utc_of_ns(window.trigger_monotonic_ns);
  shot->id = ids_.next(shot->utc_ns);
  if (const PlayedCapture* played = capture_at(parts_.captures, window.trigger.tick)) {
    file_facts_of(*played, *shot);
    played_.insert(played->id);
  }
  return shot;
}

/// Its capture may still find room where the journal did not. It is in the list then, but not
/// published: that is for what is durable.
void ShotRecorder::file_unjournaled(const std::shared_ptr<Shot>& shot) {
  parts_.archivist.expect_shot();
  parts_.archivist.store(shot, summarise(*shot, reducing_.finish(), ""));
}

bool ShotRecorder::journaled(const Shot& shot, const std::function<void()>& step) {
  try {
    step();
    return true;
  } catch (const std::exception& error) {
    journal_failures_.fetch_add(1);
    fault("store",
          fmt::format("shot {} could not be journaled; trying to file it directly: {}", shot.id,
                      error.what()),
          shot.trigger->tick, shot.samples());
    return false;
  }
}

void ShotRecorder::announce(const Shot& shot, Stopwatch& watch) {
  wire::encode(shot, parts_.store.capture_of(shot.id).string(), messages_->shot);
  watch.lap("encode-shot");
  parts_.publisher.publish_shot(messages_->shot);
  watch.lap("publish-shot");
}

}  // namespace kolsky
