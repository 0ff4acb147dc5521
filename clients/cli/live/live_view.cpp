#include "clients/cli/live/live_view.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <utility>

#include "clients/cli/reports/daemon_text.hpp"
#include "clients/cli/reports/reduced_shot.hpp"
#include "clients/cli/reports/time_text.hpp"
#include "processing/base/error.hpp"
#include "proto/codec.hpp"
#include "proto/waveform.hpp"

namespace kolsky::cli {
namespace {

constexpr std::size_t kKeptShots = 32;
constexpr std::size_t kKeptPairs = 16384;  // some seconds at the rate kolskyd previews with

JsonObject event_of(const std::string& kind, std::int64_t utc_ns) {
  JsonObject event{{"event", kind}};
  if (utc_ns != 0) {
    event.push_back({"time", iso_time(utc_ns)});
  }
  return event;
}

std::vector<double> values_of(const v1::Waveform& waveform) {
  if (waveform.dtype() == v1::Waveform::FLOAT64) {
    return wire::unpack_values(waveform, "preview");
  }
  const ChannelRecord record = wire::unpack_codes(waveform, "preview");
  std::vector<double> values;
  values.reserve(record.codes.size());
  for (const std::int32_t code : record.codes) {
    values.push_back(record.value(code));
  }
  return values;
}

void append(std::deque<double>& kept, const std::vector<double>& values) {
  kept.insert(kept.end(), values.begin(), values.end());
  if (kept.size() > kKeptPairs) {
    kept.erase(kept.begin(), kept.end() - static_cast<std::ptrdiff_t>(kKeptPairs));
  }
}

}  // namespace

void LiveView::begin(const v1::Snapshot& snapshot, const v1::ShotList& shots) {
  status_ = snapshot.status();
  shots_.assign(shots.shots().begin(), shots.shots().end());
  if (snapshot.has_last_result()) {
    show_result(snapshot.last_result());
  }
}

std::string LiveView::take(const SubscriberEvent& event) {
  if (const auto* message = std::get_if<Received>(&event)) {
    try {
      return take_message(*message);
    } catch (const InputError& error) {
      return take_unreadable(error.what());
    }
  }
  if (const auto* lost = std::get_if<Lost>(&event)) {
    return take_lost(*lost);
  }
  if (std::holds_alternative<Restarted>(event)) {
    ++restarts_;
    events_.emplace_back(event_of("restarted", 0));
    return "the daemon was started again";
  }
  if (const auto* unreadable = std::get_if<Unreadable>(&event)) {
    return take_unreadable(unreadable->reason);
  }
  return "";
}

std::string LiveView::take_message(const Received& message) {
  if (message.topic == wire::kStatusTopic) {
    return take_status(message);
  }
  if (message.topic == wire::kShotTopic) {
    return take_shot(message);
  }
  if (message.topic == wire::kResultTopic) {
    return take_result(message);
  }
  if (message.topic == wire::kFaultTopic) {
    return take_fault(message);
  }
  if (message.topic == wire::kComparisonTopic) {
    return take_comparison(message);
  }
  if (message.topic == wire::kDiagnosisTopic) {
    return take_diagnosis(message);
  }
  if (message.topic == wire::kPreviewTopic) {
    take_preview(message);
  }
  return "";
}

std::string LiveView::take_status(const Received& message) {
  v1::Status status;
  wire::parse(message.payload, "status", status);
  const bool changed = status.state() != status_.state();
  status_ = status;
  if (!changed) {
    return "";
  }
  JsonObject event = event_of("state", message.utc_ns);
  event.push_back({"state", state_name(status.state())});
  events_.emplace_back(std::move(event));
  return state_name(status.state());
}

std::string LiveView::take_shot(const Received& message) {
  v1::Shot shot;
  wire::parse(message.payload, "shot", shot);
  v1::ShotSummary& summary = summary_of(shot.id());
  summary.set_utc_ns(shot.utc_ns());
  summary.set_capture(shot.capture());
  JsonObject event = event_of("shot", message.utc_ns);
  event.push_back({"shot", shot.id()});
  event.push_back({"capture", shot.capture()});
  event.push_back({"gaps", static_cast<std::uint64_t>(shot.gaps_size())});
  events_.emplace_back(std::move(event));
  return "shot " + shot.id();
}

std::string LiveView::take_result(const Received& message) {
  v1::Result result;
  wire::parse(message.payload, "result", result);
  const v1::ShotSummary& summary = show_result(result);
  ++results_;
  JsonObject event = event_of("result", message.utc_ns);
  event.push_back({"shot", result.shot_id()});
  event.push_back({"verdict", verdict_name(summary.verdict())});
  event.push_back({"reducible", summary.reducible()});
  event.push_back({"reason", summary.reason()});
  event.push_back({"peak_stress_Pa", summary.peak_stress_pa()});
  event.push_back({"peak_strain", summary.peak_strain()});
  event.push_back({"peak_force_N", summary.peak_force_n()});
  event.push_back({"restitution", summary.restitution()});
  events_.emplace_back(std::move(event));
  return "result " + shot_line(summary, false);
}

std::string LiveView::take_fault(const Received& message) {
  v1::Fault fault;
  wire::parse(message.payload, "fault", fault);
  last_fault_ = fault.kind() + ": " + fault.text();
  JsonObject event = event_of("fault", message.utc_ns);
  event.push_back({"kind", fault.kind()});
  event.push_back({"text", fault.text()});
  event.push_back({"tick", static_cast<std::int64_t>(fault.tick())});
  event.push_back({"samples", static_cast<std::uint64_t>(fault.samples())});
  events_.emplace_back(std::move(event));
  return "fault " + last_fault_;
}

std::string LiveView::take_comparison(const Received& message) {
  v1::Comparison comparison;
  wire::parse(message.payload, "comparison", comparison);
  JsonObject event = event_of("comparison", message.utc_ns);
  event.push_back({"comparison", describe(comparison)});
  events_.emplace_back(std::move(event));
  std::string line = comparison_line(comparison, false);
  *status_.mutable_comparison() = std::move(comparison);
  return line;
}

std::string LiveView::take_diagnosis(const Received& message) {
  v1::Diagnosis diagnosis;
  wire::parse(message.payload, "diagnosis", diagnosis);
  JsonObject event = event_of("diagnosis", message.utc_ns);
  event.push_back({"diagnosis", describe(diagnosis.summary())});
  events_.emplace_back(std::move(event));
  *status_.mutable_diagnosis() = diagnosis.summary();
  return diagnosis_line(diagnosis.summary());
}

void LiveView::take_preview(const Received& message) {
  v1::Preview preview;
  wire::parse(message.payload, "preview", preview);
  for (const v1::ChannelPreview& channel : preview.channels()) {
    Trace& trace = traces_[channel.gauge()];
    trace.unit = channel.minimum().unit();
    trace.step_s = preview.step_s();
    append(trace.minimum, values_of(channel.minimum()));
    append(trace.maximum, values_of(channel.maximum()));
  }
}

std::string LiveView::take_unreadable(const std::string& reason) {
  events_.emplace_back(JsonObject{{"event", "unreadable"}, {"text", reason}});
  return "unreadable message: " + reason;
}

std::string LiveView::take_lost(const Lost& lost) {
  lost_[lost.topic] += lost.count;
  events_.emplace_back(JsonObject{{"event", "lost"},
                                  {"topic", lost.topic},
                                  {"first_sequence", lost.first_sequence},
                                  {"count", lost.count}});
  return fmt::format("{} messages of {} lost", lost.count, lost.topic);
}

v1::ShotSummary& LiveView::show_result(const v1::Result& result) {
  Reduction reduction = wire::decode(result);
  const LoopSummary loop = summarise(reduction);
  v1::ShotSummary& summary = summary_of(result.shot_id());
  summary.set_verdict(result.quality().verdict());
  summary.set_reducible(result.quality().reducible());
  summary.set_reason(result.quality().reason());
  summary.set_peak_stress_pa(loop.peak_stress_Pa);
  summary.set_peak_strain(loop.peak_strain);
  if (reduction.ball) {
    summary.set_peak_force_n(reduction.ball->peak_force_N);
    summary.set_restitution(reduction.ball->restitution().value_or(Measured{}));
  }
  if (!reduction.stress_Pa.empty() || reduction.ball) {
    last_loop_ = LastLoop{result.shot_id(), std::move(reduction)};
  }
  return summary;
}

v1::ShotSummary& LiveView::summary_of(const std::string& id) {
  const auto known = std::find_if(shots_.begin(), shots_.end(),
                                  [&](const v1::ShotSummary& shot) { return shot.id() == id; });
  if (known != shots_.end()) {
    return *known;
  }
  shots_.emplace_front();
  shots_.front().set_id(id);
  if (shots_.size() > kKeptShots) {
    shots_.pop_back();
  }
  return shots_.front();
}

std::uint64_t LiveView::lost_messages() const {
  return std::accumulate(lost_.begin(), lost_.end(), std::uint64_t{0},
                         [](std::uint64_t sum, const auto& entry) { return sum + entry.second; });
}

}  // namespace kolsky::cli
