#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace kolsky {

class TomlTable;

/// How well a model did on the captures that a step saw.
struct StepFit {
  std::int64_t captures = 0;
  double chi2_reduced = 0.0;
  double degrees_of_freedom = 0.0;
  double repeatable_share = 0.0;   ///< of the signal's energy
  double noise_floor_share = 0.0;  ///< of the signal's energy
};

/// Chi2 per residual on shots that the fits did not see.
struct StepHeldOut {
  double before = 0.0;
  double after = 0.0;
  double floor = 1.0;
};

/// What a step found of one effect.
struct StepTest {
  std::string effect;
  double strength = 0.0;
  double sd = 0.0;
  std::string unit;
  double log_p = 0.0;  ///< ln of its chance under noise, the search over all effects included
  double held_out_gain = 0.0;
  std::string verdict;
  std::vector<std::string> tied_with;
};

/// A step in a model's life: what was done, on which data and how it came out, and the model as it
/// was before.
struct ModelStep {
  std::string action;              ///< "add geometric-dispersion", "fit 8 captures"
  std::string when;                ///< UTC, ISO 8601
  std::string note;                ///< for people
  std::string data_sha256;         ///< of the captures the step saw; empty for other steps
  std::string software;            ///< version that took the step
  std::string verdict;             ///< of a diagnosis
  std::vector<std::string> added;  ///< effects that the step put in, in their order
  std::vector<double> seeds;       ///< of what it simulated
  /// The model that it began with was edited by hand after the step before: `before` has more than
  /// that step did.
  bool edited_by_hand = false;
  std::optional<StepFit> fit;
  std::optional<StepHeldOut> held_out;
  std::vector<StepTest> tests;
  std::string parent;  ///< SHA-256 of the text below
  std::string before;  ///< the whole model file before the step, without its own history
};

/// @throws InputError: file, line, key and mend; also where `before` is not what `parent` says
[[nodiscard]] ModelStep read_step(const TomlTable& table);

/// One [[history]] table of a model file.
[[nodiscard]] std::string format_step(const ModelStep& step);

/// SHA-256 of a whole history as a model file holds it: none of its steps can be altered or cut off
/// without it showing.
[[nodiscard]] std::string ledger_digest(const std::vector<ModelStep>& history);

}  // namespace kolsky
