#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "processing/criticism/search/candidate_table.hpp"
#include "processing/criticism/search/safeguards.hpp"

namespace kolsky {

enum class DiagnosisVerdict { named, tied, unknown, adequate, untestable, bad_data };

[[nodiscard]] std::string name_of(DiagnosisVerdict verdict);

struct HeldOut {
  double before = 0.0;  ///< chi2 per residual on shots the fit did not see, what is filed included
  double after = 0.0;
  double floor = 1.0;  ///< what noise alone leaves
};

struct NextExperiment {
  std::string change;
  std::vector<std::string> separates;
  /// At how many the effect would stand with the nearest rival beside it, in as many shots as now;
  /// 0: not reckoned.
  double deviations = 0.0;
};

struct Diagnosis {
  DiagnosisVerdict verdict = DiagnosisVerdict::adequate;
  std::vector<std::string> effects;  ///< certified, in the order added
  std::map<std::string, std::vector<std::string>> tied_with;
  Misfit before;
  Misfit after;
  HeldOut held_out;
  std::vector<CandidateResult> candidates;
  std::vector<NextExperiment> next_experiment;  ///< of a ball; else see next_experiments()
  std::vector<std::string> notes;  ///< how it was certified and what limits it, for people
  std::optional<Model> model;      ///< with the certified effects, fitted
  double unexplained_log_p = 0.0;  ///< ln probability of what remains in the final residuals
};

struct DiagnosisOptions {
  std::size_t most_effects = 3;  ///< that are sought, those not counted that are no surprise
  double log_alpha = kFalseClaim;
  std::function<void(const std::string&)> progress = [](const std::string&) {};
  Safeguards safeguards{};
};

/// Finds what a model lacks (diagnosis.md). @throws InputError as read_campaign
[[nodiscard]] Diagnosis diagnose(Study& study, const Model& model, const DiagnosisOptions& options);

}  // namespace kolsky
