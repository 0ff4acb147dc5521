#pragma once

#include <string>

#include "clients/cli/reports/json_value.hpp"
#include "clients/terminal/terminal.hpp"
#include "kolsky/v1/kolsky.pb.h"

namespace kolsky::cli {

[[nodiscard]] std::string state_name(v1::DaemonState state);
[[nodiscard]] Ink state_ink(v1::DaemonState state);

/// "pass", "warn", "fail", or "pending" where nobody judged yet.
[[nodiscard]] std::string verdict_name(v1::Quality::Verdict verdict);
[[nodiscard]] Ink verdict_ink(v1::Quality::Verdict verdict);

[[nodiscard]] JsonValue describe(const v1::Status& status);
[[nodiscard]] JsonValue describe(const v1::ShotSummary& shot);
[[nodiscard]] JsonValue describe(const v1::Preflight& preflight);
[[nodiscard]] JsonValue describe(const v1::Comparison& comparison);
[[nodiscard]] JsonValue describe(const v1::DiagnosisSummary& summary);
/// As `kolsky diagnose --json` has it, with what it is of.
[[nodiscard]] JsonValue describe(const v1::Diagnosis& diagnosis);

/// One line: state, digitiser, operator.
[[nodiscard]] std::string headline(const v1::Status& status, bool colour);

/// What was read and lost since the daemon started, in one line.
[[nodiscard]] std::string counters_line(const v1::Status& status, bool colour);

/// What is stored, in one line.
[[nodiscard]] std::string store_line(const v1::Status& status);

/// One line each, with how large the noise is.
[[nodiscard]] std::string channel_line(const v1::ChannelStatus& channel);

/// A shot in one line: id, verdict, outcome.
[[nodiscard]] std::string shot_line(const v1::ShotSummary& shot, bool colour);

/// The last shot beside the model: light, misfit, trend and where it fails most.
[[nodiscard]] std::string comparison_line(const v1::Comparison& comparison, bool colour);
[[nodiscard]] std::string diagnosis_state(v1::DiagnosisSummary::State state);
[[nodiscard]] std::string diagnosis_line(const v1::DiagnosisSummary& diagnosis);
/// One line per check.
[[nodiscard]] std::string preflight_text(const v1::Preflight& preflight, bool colour);

}  // namespace kolsky::cli
