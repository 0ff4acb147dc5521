#pragma once

#include <map>

#include "tests/hidden_effects/verdict.hpp"

namespace kolsky::scoring {

/// One line of the table: what was measured, what is wanted, what came out over how many.
struct Measure {
  std::string name;
  std::string wanted;
  std::optional<double> got;  ///< none where nothing was there to measure
  std::size_t cases = 0;
  bool met = false;
};

[[nodiscard]] std::vector<Measure> measures(const std::vector<Verdict>& verdicts);
[[nodiscard]] std::string table_text(const std::vector<Measure>& measures);
/// Rows: what was hidden; columns: what was said, most frequent first.
[[nodiscard]] std::string confusion_text(const std::vector<Verdict>& verdicts);
/// Where models without an effect fail, against what `compare` marks, per effect.
[[nodiscard]] std::map<std::string, Localisation> places_by_effect(
    const std::vector<Verdict>& verdicts);
[[nodiscard]] std::string places_text(const std::vector<Verdict>& verdicts);
/// Verdicts on the same cases: with every safeguard ("all") and without one of them.
using BySafeguard = std::map<std::string, std::vector<Verdict>>;
/// What the diagnosis claims without each of its safeguards.
[[nodiscard]] std::string safeguards_text(const BySafeguard& verdicts);
/// Share found over the multiple of the smallest identifiable size, per effect.
[[nodiscard]] std::string power_text(const std::vector<Verdict>& verdicts);

}  // namespace kolsky::scoring
