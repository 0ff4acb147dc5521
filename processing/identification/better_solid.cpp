#include "processing/identification/better_solid.hpp"

#include "processing/reduction/formatted.hpp"

namespace kolsky {

namespace {

constexpr double kClearlyAhead = 10.0;

}  // namespace

const BarFit& fit_to_file(const BarIdentification& result) {
  return result.fit.solid == SolidKind::three_element ? result.three_element : result.fit;
}

std::optional<BetterSolid> better_solid(const BarIdentification& result) {
  const BarFit& filed = fit_to_file(result);
  std::optional<BetterSolid> better;
  for (const Alternative& other : result.alternatives) {
    const BarTheory& theory = other.theory;
    if (!other.failed.empty() || theory.solid == filed.solid || theory.waves != filed.theory ||
        theory.far_end != filed.far_end) {
      continue;
    }
    const double ahead = other.log_evidence - filed.log_evidence;
    if (ahead > (better ? better->log_evidence_ahead : kClearlyAhead)) {
      better = BetterSolid{theory.solid, ahead, other.chi2_reduced};
    }
  }
  return better;
}

std::string cost_of_filing(const BarFit& filed, const BetterSolid& better) {
  const std::string name = name_of(better.solid);
  return formatted(
      "a %s solid is ahead of the %s one that reductions would go by, by a log evidence of %.0f: "
      "that leaves a reduced chi2 of %.3g, it %.3g; --solid %s files it",
      name.c_str(), name_of(filed.solid).c_str(), better.log_evidence_ahead, filed.chi2_reduced,
      better.chi2_reduced, name.c_str());
}

}  // namespace kolsky
