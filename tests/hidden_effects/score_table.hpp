#pragma once

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
/// Share found over the multiple of the smallest identifiable size, per effect.
[[nodiscard]] std::string power_text(const std::vector<Verdict>& verdicts);

}  // namespace kolsky::scoring
