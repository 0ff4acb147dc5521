#include "clients/cli/reports/candidates_page.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace kolsky::cli {

namespace {

std::string number_text(double value) {
  return !std::isfinite(value) ? "" : value == 0.0 ? "0" : fmt::format("{:.3g}", value);
}

std::string to_a_tenth(double value) {
  return std::isfinite(value) ? fmt::format("{:.1f}", value) : "";
}

}  // namespace

PageTable candidates_table(const Diagnosis& diagnosis, const std::string& held_out) {
  std::vector<CandidateResult> ranked = diagnosis.candidates;
  std::ranges::stable_sort(ranked, {}, &CandidateResult::log_p);
  PageTable table{{"effect", "strength", "deviation", "unit", "ln p", "chi-square gain",
                   "on held-out " + held_out, "smallest detectable", "smallest told apart",
                   "nearest rival", "verdict"},
                  {}};
  for (const CandidateResult& c : ranked) {
    table.rows.push_back({c.effect, number_text(c.strength), number_text(c.sd), c.unit,
                          to_a_tenth(c.log_p), to_a_tenth(c.gain), to_a_tenth(c.held_out_gain),
                          number_text(c.detectable), number_text(c.identifiable), c.nearest_rival,
                          c.verdict});
  }
  return table;
}

}  // namespace kolsky::cli
