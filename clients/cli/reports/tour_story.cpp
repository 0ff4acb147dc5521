#include "clients/cli/reports/tour_story.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "clients/terminal/terminal.hpp"

namespace kolsky::cli {

namespace {

const StepTest* test_of(const ModelStep& step, const std::string& id) {
  const auto found = std::find_if(step.tests.begin(), step.tests.end(),
                                  [&](const StepTest& test) { return test.effect == id; });
  return found == step.tests.end() ? nullptr : &*found;
}

/// Of an effect that was claimed, those it cannot be told from.
std::vector<std::string> ties_of(const ModelStep& step, const std::string& id) {
  const StepTest* test = test_of(step, id);
  return test == nullptr ? std::vector<std::string>{} : test->tied_with;
}

}  // namespace

TourVerdict judge(const Hidden& hidden, const ModelStep& step) {
  TourVerdict verdict;
  if (hidden.id.empty() || !hidden.in_library) {
    const bool quiet = step.added.empty() && (hidden.id.empty() || step.verdict == "unknown");
    verdict.end =
        quiet ? TourEnd::rightly_quiet : (step.added.empty() ? TourEnd::missed : TourEnd::wrong);
    // Nothing hidden and yet "unknown" is a false alarm, not a miss.
    if (hidden.id.empty() && step.verdict == "unknown") {
      verdict.end = TourEnd::wrong;
    }
    return verdict;
  }
  bool other = false;
  bool own = false;
  bool tied = false;
  for (const std::string& id : step.added) {
    const std::vector<std::string> ties = ties_of(step, id);
    const bool among = std::find(ties.begin(), ties.end(), hidden.id) != ties.end();
    own = own || id == hidden.id;
    tied = tied || among || (id == hidden.id && !ties.empty());
    other = other || (id != hidden.id && !among);
  }
  if (const StepTest* test = test_of(step, hidden.id); test != nullptr && (own || tied)) {
    verdict.strength = test->strength;
    verdict.sd = test->sd;
  }
  if (other) {
    verdict.end = TourEnd::wrong;
  } else if (tied) {
    verdict.end = TourEnd::among_tied;
  } else {
    verdict.end = own ? TourEnd::found : TourEnd::missed;
  }
  return verdict;
}

std::string verdict_words(const ModelStep& step) {
  if (step.verdict == "adequate") {
    return "The diagnosis finds nothing missing: the model's misfit is what noise leaves. An "
           "effect "
           "too small for these shots would look the same; the column \"detectable\" says what "
           "size "
           "would have been seen.";
  }
  if (step.verdict == "unknown") {
    return "Something repeats from shot to shot, and no effect of the library explains it. The "
           "diagnosis says so and names nothing: a wrong name would be worse. The places that fail "
           "tell where on the bench to look.";
  }
  if (step.verdict != "named" && step.verdict != "tied") {
    return "The verdict is " + step.verdict +
           ": with these records the question cannot be settled.";
  }
  std::string text = "What is missing: " + joined(step.added) + ".";
  for (const std::string& id : step.added) {
    const std::vector<std::string> ties = ties_of(step, id);
    if (!ties.empty()) {
      text += " These records cannot tell " + id + " from " + joined(ties) +
              ": the model holds the first, the line \"next\" says which change of the bench would "
              "part them.";
    }
  }
  return text + " It was refitted beside its rivals and foretells shots that the fit did not see.";
}

std::string truth_words(const Hidden& hidden) {
  std::string text = "The truth: " + hidden.words;
  if (!hidden.id.empty() && hidden.in_library) {
    text += fmt::format(" ({}, {} = {:.4g}{})", hidden.id, hidden.parameter, hidden.strength,
                        hidden.unit == "-" ? "" : " " + hidden.unit);
  }
  text += ".";
  if (!hidden.id.empty() && !hidden.in_library) {
    text += " No effect of the library describes it.";
  }
  return text;
}

std::string truth_words(const Hidden& hidden, const TourVerdict& verdict) {
  std::string text = truth_words(hidden);
  switch (verdict.end) {
    case TourEnd::found:
      text += " Found.";
      break;
    case TourEnd::among_tied:
      text += " It is in the set that was reported as tied.";
      break;
    case TourEnd::rightly_quiet:
      text += hidden.id.empty() ? " Rightly, nothing was claimed."
                                : " Rightly called unknown, and nothing was named.";
      break;
    case TourEnd::missed:
      text += " It was missed.";
      break;
    case TourEnd::wrong:
      text += " What was claimed is not it, or not it alone: the diagnosis erred here.";
      break;
  }
  if (verdict.strength && verdict.sd > 0.0) {
    text += fmt::format(" Strength found: {:.4g} ± {:.2g}{}, {:.1f} deviations from the truth.",
                        *verdict.strength, verdict.sd, hidden.unit == "-" ? "" : " " + hidden.unit,
                        std::abs(*verdict.strength - hidden.strength) / verdict.sd);
  }
  return text;
}

}  // namespace kolsky::cli
