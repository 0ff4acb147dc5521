#include "tests/hidden_effects/plain_faults.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace kolsky::scoring {

namespace {

std::string fault_of(const Verdict& verdict) {
  if (verdict.answered == "failed" || verdict.answered == "timeout") {
    return verdict.answered + " " + verdict.error;
  }
  const std::string said = fmt::format("{} {}", verdict.answered, fmt::join(verdict.named, ", "));
  switch (verdict.kind) {
    case CaseKind::null:
    case CaseKind::absorbed:
    case CaseKind::withheld:
      return verdict.named.empty() ? "" : "claimed falsely: " + said;
    case CaseKind::single:
      if (verdict.found == 1) {
        return "";
      }
      if (!verdict.named.empty()) {
        return "named in its place: " + said;
      }
      // Rounding must not make it less than clear.
      return verdict.multiples.front() > 0.999 * kClear ? "clear, and missed: " + said : "";
    case CaseKind::tied:
    case CaseKind::two:
      return "";
  }
  return "";
}

}  // namespace

std::vector<std::string> plain_faults(const std::vector<Verdict>& verdicts) {
  std::vector<std::string> faults;
  for (const Verdict& verdict : verdicts) {
    if (const std::string fault = fault_of(verdict); !fault.empty()) {
      faults.push_back(fmt::format(
          "{}: hidden {}: {}", verdict.id,
          verdict.truth.empty() ? "nothing" : fmt::format("{}", fmt::join(verdict.truth, ", ")),
          fault));
    }
  }
  return faults;
}

}  // namespace kolsky::scoring
