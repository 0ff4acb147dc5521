#include "clients/cli/reports/daemon_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "clients/cli/reports/share_text.hpp"
#include "clients/figure/layout.hpp"
#include "proto/light.hpp"

namespace kolsky::cli {
namespace {

constexpr double kBytesPerGigabyte = 1e9;

std::string counted(const std::string& what, std::uint64_t count, bool colour) {
  const std::string text = fmt::format(", {} {}", what, count);
  return count == 0 ? text : inked(text, Ink::bad, colour);
}

}  // namespace

std::string state_name(v1::DaemonState state) {
  switch (state) {
    case v1::STARTING:
      return "starting";
    case v1::DISARMED:
      return "disarmed";
    case v1::ARMED:
      return "armed";
    case v1::CAPTURING:
      return "capturing";
    case v1::DISCONNECTED:
      return "disconnected";
    case v1::ENDED:
      return "ended";
    default:
      return "unknown";
  }
}

Ink state_ink(v1::DaemonState state) {
  switch (state) {
    case v1::ARMED:
    case v1::CAPTURING:
      return Ink::good;
    case v1::DISCONNECTED:
      return Ink::bad;
    default:
      return Ink::doubtful;
  }
}

std::string verdict_name(v1::Quality::Verdict verdict) {
  switch (verdict) {
    case v1::Quality::PASS:
      return "pass";
    case v1::Quality::WARN:
      return "warn";
    case v1::Quality::FAIL:
      return "fail";
    default:
      return "pending";
  }
}

Ink verdict_ink(v1::Quality::Verdict verdict) {
  switch (verdict) {
    case v1::Quality::PASS:
      return Ink::good;
    case v1::Quality::FAIL:
      return Ink::bad;
    default:
      return Ink::doubtful;
  }
}

std::string headline(const v1::Status& status, bool colour) {
  std::string text = inked(state_name(status.state()), state_ink(status.state()), colour) + "  " +
                     status.digitiser_uri() + (status.simulated() ? " (simulated)" : "") + "  " +
                     with_unit(status.sampling_frequency_hz(), "Hz") + "  operator " +
                     (status.operator_id().empty() ? "none" : status.operator_id());
  return text;
}

std::string counters_line(const v1::Status& status, bool colour) {
  return fmt::format("samples {}", status.samples_read()) +
         counted("missing", status.samples_missing(), colour) +
         counted("unknown gaps", status.gaps_of_unknown_length(), colour) +
         counted("overflows", status.overflows(), colour) +
         counted("overruns", status.ring_overruns(), colour) +
         counted("reconnects", status.reconnects(), colour);
}

std::string store_line(const v1::Status& status) {
  constexpr double kNoRoom_GB = 0.05;
  const double free_GB = static_cast<double>(status.disk_free_bytes()) / kBytesPerGigabyte;
  const bool full = free_GB < kNoRoom_GB && status.shots_stored() < status.triggers();
  return fmt::format(
      "shots {} stored of {} triggered since the start, {:.1f} GB free{}", status.shots_stored(),
      status.triggers(), free_GB,
      full ? ": the disk is full, shots wait in the journal until there is room" : "");
}

std::string channel_line(const v1::ChannelStatus& channel) {
  const DisplayUnit unit =
      display_unit(channel.unit(), std::max({std::abs(channel.baseline()), channel.noise_rms(),
                                             std::abs(channel.trigger_level())}));
  std::string text =
      fmt::format("{}  at {:.4g}, noise {:.3g} rms", channel.gauge(),
                  channel.baseline() * unit.factor, channel.noise_rms() * unit.factor);
  if (channel.trigger_level() != 0.0) {
    text += fmt::format(", level {:.4g}", channel.trigger_level() * unit.factor);
  }
  return text + " " + unit.name;
}

std::string shot_line(const v1::ShotSummary& shot, bool colour) {
  const std::string verdict =
      inked(padded_right(verdict_name(shot.verdict()), 8), verdict_ink(shot.verdict()), colour);
  std::string outcome =
      shot.reducible() ? fmt::format("{} peak, strain {}", with_unit(shot.peak_stress_pa(), "Pa"),
                                     with_unit(shot.peak_strain(), "strain"))
                       : shot.reason();
  if (shot.peak_force_n() > 0.0) {
    outcome = with_unit(shot.peak_force_n(), "N") + " peak" +
              (shot.restitution() > 0.0 ? fmt::format(", restitution {:.3f}", shot.restitution())
                                        : std::string());
  }
  return shot.id() + "  " + verdict + outcome;
}

std::string comparison_line(const v1::Comparison& comparison, bool colour) {
  if (!comparison.comparable()) {
    return "model: not compared: " + comparison.reason();
  }
  const Ink ink = comparison.light() == v1::Comparison::GREEN ? Ink::good
                  : comparison.light() == v1::Comparison::RED ? Ink::bad
                                                              : Ink::doubtful;
  std::string text =
      "model: " + inked(wire::name_of(comparison.light()), ink, colour) +
      fmt::format(", chi2/N {:.3g}, {} of the signal beyond noise",
                  comparison.misfit().chi2_reduced(), share_text(comparison.excess_share()));
  if (comparison.trend_size() > 1) {
    text += ", last shots";
    constexpr int kShown = 6;
    for (int n = std::max(0, comparison.trend_size() - kShown); n < comparison.trend_size(); ++n) {
      text += fmt::format(" {:.3g}", comparison.trend(n));
    }
  }
  if (comparison.places_size() > 0) {
    const v1::MisfitPlace& worst = comparison.places(0);
    const std::string place =
        worst.gauge().empty()
            ? worst.window()
            : fmt::format("{} {} {:.3g}-{:.3g} kHz", worst.gauge(), worst.window(),
                          worst.low_hz() * 1e-3, worst.high_hz() * 1e-3);
    text += fmt::format(", most at {} ({:.2g} sigma)", place, worst.sigma());
  }
  return text;
}

std::string diagnosis_state(v1::DiagnosisSummary::State state) {
  switch (state) {
    case v1::DiagnosisSummary::RUNNING:
      return "running";
    case v1::DiagnosisSummary::DONE:
      return "done";
    case v1::DiagnosisSummary::CANCELLED:
      return "cancelled";
    case v1::DiagnosisSummary::FAILED:
      return "failed";
    default:
      return "none";
  }
}

std::string diagnosis_line(const v1::DiagnosisSummary& diagnosis) {
  std::string text = "diagnosis " + diagnosis.id() + ": ";
  if (diagnosis.state() != v1::DiagnosisSummary::DONE) {
    return text + diagnosis_state(diagnosis.state()) + ", " + diagnosis.step();
  }
  text += diagnosis.verdict();
  for (const std::string& id : diagnosis.effects()) {
    text += " " + id;
  }
  return text;
}

std::string preflight_text(const v1::Preflight& preflight, bool colour) {
  std::string text;
  for (const v1::PreflightCheck& check : preflight.checks()) {
    text += "  " +
            inked(check.ok() ? "ok    " : "FAIL  ", check.ok() ? Ink::good : Ink::bad, colour) +
            padded_right(check.name(), 12) + " " + check.text() + "\n";
  }
  return text;
}

}  // namespace kolsky::cli
