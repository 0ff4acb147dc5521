#include "processing/identification/better_solid.hpp"

#include "processing/reduction/formatted.hpp"

namespace kolsky {

namespace {

constexpr double kClearlyAhead = 10.0;

}  // namespace

std::optional<BetterSolid> better_solid(const BarIdentification& result) {
  const BarFit& three = result.three_element;
  std::optional<BetterSolid> better;
  for (const Alternative& other : result.alternatives) {
    const BarTheory& theory = other.theory;
    if (!other.failed.empty() || theory.solid == SolidKind::three_element ||
        theory.waves != three.theory || theory.far_end != three.far_end) {
      continue;
    }
    const double ahead = other.log_evidence - three.log_evidence;
    if (ahead > (better ? better->log_evidence_ahead : kClearlyAhead)) {
      better = BetterSolid{theory.solid, ahead, other.chi2_reduced};
    }
  }
  return better;
}

std::string cost_of_three_elements(const BetterSolid& better, const BarFit& three_element) {
  return formatted(
      "reductions carry waves by three elements, the only ones a material file holds, but a %s "
      "solid is ahead of them by a log evidence of %.0f: they leave a reduced chi2 of %.3g, it "
      "%.3g",
      name_of(better.solid).c_str(), better.log_evidence_ahead, three_element.chi2_reduced,
      better.chi2_reduced);
}

}  // namespace kolsky
