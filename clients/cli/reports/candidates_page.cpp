#include "clients/cli/reports/candidates_page.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "clients/cli/reports/diagnosis_text.hpp"

namespace kolsky::cli {

namespace {

std::string number_text(double value) {
  return !std::isfinite(value) ? "" : value == 0.0 ? "0" : fmt::format("{:.3g}", value);
}

std::string size_text(double size, const std::string& unit) {
  const std::string number = number_text(size);
  return number.empty() || unit == "-" ? number : number + " " + unit;
}

}  // namespace

PageTable candidates_table(const Diagnosis& diagnosis, const std::string& held_out) {
  std::vector<CandidateResult> ranked = diagnosis.candidates;
  std::ranges::stable_sort(ranked, {}, &CandidateResult::log_p);
  PageTable table{{"effect", "verdict", "strength", "ln p", "gain", "held-out " + held_out,
                   "detectable", "told apart", "nearest rival"},
                  {}};
  for (const CandidateResult& c : ranked) {
    const std::string strength = c.verdict == CandidateVerdict::untestable ? "" : strength_text(c);
    table.rows.push_back({c.effect, kolsky::name_of(c.verdict), strength, gain_text(c.log_p),
                          gain_text(c.gain), gain_text(c.held_out_gain),
                          size_text(c.detectable, c.unit), size_text(c.identifiable, c.unit),
                          c.nearest_rival});
  }
  return table;
}

}  // namespace kolsky::cli
