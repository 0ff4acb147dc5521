#pragma once

#include "tests/hidden_effects/case.hpp"

namespace kolsky::scoring {

/// The program under test, run as its users run it.
struct Analyser {
  std::filesystem::path program = "kolsky";
  double timeout_s = 120.0;
  std::string more;  ///< further arguments of diagnose, for trying a safeguard's absence
};

/// What it said of a case. `json` is null where it said nothing that can be read.
struct Answer {
  nlohmann::json json;
  double seconds = 0.0;
  int code = 0;       ///< 124 where it ran out of time
  std::string error;  ///< what it wrote on stderr
};

/// Makes the paper's model for the case's bench and has the captures diagnosed.
[[nodiscard]] Answer diagnose(const Analyser& analyser, const CaseFiles& files);

/// Fits the paper's model, as diagnose() made it, and compares it.
[[nodiscard]] Answer compare_base(const Analyser& analyser, const CaseFiles& files);

/// Compares the model that the diagnosis wrote, as it stands.
[[nodiscard]] Answer compare_found(const Analyser& analyser, const CaseFiles& files);

/// From the model that it began with to the one that the diagnosis wrote.
[[nodiscard]] Answer waterfall(const Analyser& analyser, const CaseFiles& files);

/// Fits the model that the diagnosis wrote, with what it found in it. @return fit's answer
[[nodiscard]] Answer refit(const Analyser& analyser, const CaseFiles& files);

}  // namespace kolsky::scoring
