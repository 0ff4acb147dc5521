#include "processing/specimen/specimen_family.hpp"

#include <cmath>
#include <optional>
#include <utility>

#include "processing/base/error.hpp"

namespace kolsky {

namespace {

/// Logarithm of a factor that makes of an element something that shows nowhere.
const double kNothing = std::log(1e4);
/// The same of a dashpot in line, whose strain grows with the time.
const double kNoFlow = std::log(1e7);
const double kLeastPower = std::log(0.1);
const double kTen = std::log(10.0);

/// Where a search of a family begins, and how far it may go: first three elements themselves.
struct FamilyStarts {
  std::vector<std::vector<double>> logs;
  LogBounds bounds;
};

LogBounds about(const std::vector<double>& logs) {
  LogBounds bounds{logs, logs};
  for (std::size_t i = 0; i < logs.size(); ++i) {
    bounds.lower[i] -= kNothing;
    bounds.upper[i] += kNothing;
  }
  return bounds;
}

FamilyStarts fractional_starts(double E1, double E2, double eta2) {
  FamilyStarts starts{{{E1, E2, eta2, 0.0}, {E1, E2, eta2, std::log(0.7)}},
                      about({E1, E2, eta2, 0.0})};
  starts.bounds.lower.back() = kLeastPower;
  starts.bounds.upper.back() = 0.0;
  return starts;
}

/// A second branch ten times slower and ten times faster than the first.
FamilyStarts two_kelvin_starts(double E1, double E2, double eta2) {
  return {{{E1, E2, eta2, E2 + kNothing, eta2 + kNothing},
           {E1, E2, eta2, E2 + kTen, eta2 + 2.0 * kTen},
           {E1, E2, eta2, E2 + kTen, eta2}},
          about({E1, E2, eta2, E2, eta2})};
}

/// Two further branches, one slower and one faster than the first by ten times.
FamilyStarts three_kelvin_starts(double E1, double E2, double eta2) {
  return {{{E1, E2, eta2, E2 + kNothing, eta2 + kNothing, E2 + kNothing, eta2 + kNothing},
           {E1, E2, eta2, E2 + kTen, eta2 + 2.0 * kTen, E2 + kTen, eta2}},
          about({E1, E2, eta2, E2, eta2, E2, eta2})};
}

/// Three further branches, one slower, one faster and one much slower than the first.
FamilyStarts four_kelvin_starts(double E1, double E2, double eta2) {
  const double E = E2 + kNothing;
  const double eta = eta2 + kNothing;
  const double weak = E2 + kTen;
  return {{{E1, E2, eta2, E, eta, E, eta, E, eta},
           {E1, E2, eta2, weak, eta2 + 2.0 * kTen, weak, eta2, weak, eta2 + 3.0 * kTen}},
          about({E1, E2, eta2, E2, eta2, E2, eta2, E2, eta2})};
}

FamilyStarts fluid_starts(double E1, double E2, double eta2) {
  FamilyStarts starts{{{E1, eta2 + kNoFlow, E2, eta2}, {E1, eta2 + 2.0 * kTen, E2, eta2}},
                      about({E1, eta2, E2, eta2})};
  starts.bounds.upper[1] = eta2 + kNoFlow;
  return starts;
}

FamilyStarts starts_of(SolidKind solid, const std::vector<double>& logs) {
  const double E1 = logs[0];
  const double E2 = logs[1];
  const double eta2 = logs[2];
  switch (solid) {
    case SolidKind::fractional:
      return fractional_starts(E1, E2, eta2);
    case SolidKind::two_kelvin:
      return two_kelvin_starts(E1, E2, eta2);
    case SolidKind::three_kelvin:
      return three_kelvin_starts(E1, E2, eta2);
    case SolidKind::four_kelvin:
      return four_kelvin_starts(E1, E2, eta2);
    case SolidKind::four_element_fluid:
      return fluid_starts(E1, E2, eta2);
    case SolidKind::three_element:
      break;
  }
  return {{logs}, about(logs)};
}

/// The best of all starts; of equals the first, which is the nearest to three elements.
SpecimenMinimum best_of(SpecimenSearch& search, const FamilyStarts& starts,
                        const std::vector<double>& moves, const Eigen::MatrixXd& weights) {
  constexpr double kEqual = 0.01;
  std::optional<SpecimenMinimum> best;
  std::optional<InputError> refusal;
  for (const std::vector<double>& start : starts.logs) {
    try {
      SpecimenMinimum found = search.minimise_held(start, moves, weights, starts.bounds);
      if (!best || found.chi2 < best->chi2 - kEqual) {
        best = std::move(found);
      }
    } catch (const InputError& error) {
      refusal = error;
    }
  }
  if (!best) {
    throw *refusal;
  }
  return *best;
}

/// From there on by its own weights, taken anew until they no longer move chi2. As it was, where
/// that leads astray.
SpecimenMinimum by_own_weights(SpecimenSearch& search, const LogBounds& bounds,
                               const SpecimenMinimum& from) {
  constexpr int kMostRounds = 5;
  constexpr double kSettled = 0.1;
  SpecimenMinimum best = from;
  try {
    for (int round = 0; round < kMostRounds; ++round) {
      const double before = best.chi2;
      best = search.minimise_held(best.parameters, best.moves, search.weights_at(best), bounds);
      if (std::abs(best.chi2 - before) < kSettled) {
        break;
      }
    }
  } catch (const InputError&) {
    return from;
  }
  return best;
}

}  // namespace

SpecimenMinimum search_family(SpecimenLikelihood& likelihood, SolidKind solid,
                              const ShpbTheory& theory, const SpecimenMinimum& three_element) {
  const Eigen::MatrixXd weights =
      SpecimenSearch(likelihood, SolidKind::three_element, theory).weights_at(three_element);
  SpecimenSearch search(likelihood, solid, theory);
  const FamilyStarts starts = starts_of(solid, three_element.parameters);
  const SpecimenMinimum held = best_of(search, starts, three_element.moves, weights);
  if (held.chi2 > three_element.chi2 - kWorthwhile) {
    return held;
  }
  SpecimenMinimum own = by_own_weights(search, starts.bounds, held);
  return own.chi2 < three_element.chi2 ? own : held;
}

}  // namespace kolsky
