#include "processing/identification/bar_identification.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "processing/base/bar_model_check.hpp"
#include "processing/base/error.hpp"
#include "processing/identification/bar_data.hpp"
#include "processing/identification/bar_warnings.hpp"
#include "processing/identification/better_solid.hpp"
#include "processing/identification/explanations.hpp"

namespace kolsky {

namespace {

constexpr double kToldApart = 5.0;  // odds of 150 to 1
constexpr double kPartialAhead = 10.0;
constexpr double kPaperBand_Hz = 15e3;
/// A loss that stands out by so many of its deviations leaves an elastic bar behind by a log
/// evidence of half their square, a hundred times what its two numbers less can gain.
constexpr double kLossInDeviations = 50.0;

/// The best of some fits, and by how much it is ahead of the next.
struct Best {
  const BarFit* fit = nullptr;
  ChoiceByEvidence choice;
};

Best best_of(const std::vector<const BarFit*>& fits) {
  Best best;
  double second = 0.0;
  bool has_second = false;
  for (const BarFit* fit : fits) {
    if (fit == nullptr) {
      continue;
    }
    if (best.fit == nullptr || fit->log_evidence > best.fit->log_evidence) {
      if (best.fit != nullptr) {
        second = best.fit->log_evidence;
        has_second = true;
      }
      best.fit = fit;
    } else if (!has_second || fit->log_evidence > second) {
      second = fit->log_evidence;
      has_second = true;
    }
  }
  best.choice.ahead = has_second ? best.fit->log_evidence - second : 0.0;
  best.choice.told_apart = has_second && best.choice.ahead > kToldApart;
  return best;
}

/// Adds to a fit's covariance how far others that explain the records nearly as well lie from it,
/// by their odds.
void take_in(const std::vector<const BarFit*>& others, BarFit& fit) {
  double odds = 1.0;
  for (const BarFit* other : others) {
    odds += other != nullptr ? std::exp(other->log_evidence - fit.log_evidence) : 0.0;
  }
  for (const BarFit* other : others) {
    if (other == nullptr) {
      continue;
    }
    const double share = std::exp(other->log_evidence - fit.log_evidence) / odds;
    for (std::size_t i = 0; i < fit.parameters.size(); ++i) {
      const double di = other->parameters[i].value - fit.parameters[i].value;
      for (std::size_t j = 0; j < fit.parameters.size(); ++j) {
        const double dj = other->parameters[j].value - fit.parameters[j].value;
        fit.covariance[i][j] += share * (other->covariance[i][j] - fit.covariance[i][j] + di * dj);
      }
    }
  }
  for (std::size_t i = 0; i < fit.parameters.size(); ++i) {
    fit.parameters[i].sd = std::sqrt(fit.covariance[i][i]);
  }
}

std::vector<FittedNumber> over_shots(const BarFit& fit) {
  std::vector<FittedNumber> numbers = fit.parameters;
  const auto count = static_cast<double>(fit.shots.size());
  // What stands for no loss no shot has by itself.
  for (std::size_t m = 0; m < (fit.lossless ? 1 : numbers.size()); ++m) {
    double sum = 0.0;
    double squares = 0.0;
    for (const ShotEstimate& shot : fit.shots) {
      sum += shot.parameters[m].value;
    }
    for (const ShotEstimate& shot : fit.shots) {
      squares += std::pow(shot.parameters[m].value - sum / count, 2);
    }
    numbers[m].value = sum / count;
    numbers[m].sd = count > 1.0 ? std::sqrt(squares / (count - 1.0)) : numbers[m].sd;
  }
  return numbers;
}

BarTheory theory_of(const BarFit& fit) {
  return {fit.theory, fit.solid, fit.far_end, fit.lossless};
}

/// Whether the loss is so clear that to fit a bar without any would be a waste.
bool loss_stands_out(const BarFit& fit) {
  const FittedNumber& E2 = fit.parameters[1];
  return !fit.lossless && kLossInDeviations * E2.sd < E2.value;
}

/// One gauge lives by what the far end returns: it must return something.
std::vector<FarEndReturn> ends_to_try(const BarIdentificationOptions& options, bool two_passes) {
  if (options.far_end) {
    return {*options.far_end};
  }
  return {FarEndReturn::free, two_passes ? FarEndReturn::partial : FarEndReturn::none};
}

/// Where all shots' are known.
std::optional<double> mean_temperature_K(const std::vector<Shot>& shots) {
  double sum_K = 0.0;
  for (const Shot& shot : shots) {
    const auto temperature_K = temperature_of(shot);
    if (!temperature_K) {
      return std::nullopt;
    }
    sum_K += *temperature_K;
  }
  return sum_K / static_cast<double>(shots.size());
}

/// What is open about a bar of three elements.
struct Open {
  std::vector<WaveTheory> waves;
  std::vector<FarEndReturn> ends;
  bool two_passes = false;

  Open(const BarIdentificationOptions& options, const BarData& data)
      : waves(options.theory
                  ? std::vector{*options.theory}
                  : std::vector{WaveTheory::elementary, WaveTheory::exact, WaveTheory::love}),
        ends(ends_to_try(options, data.two_passes())),
        two_passes(data.two_passes()) {}

  [[nodiscard]] std::vector<BarTheory> with_end(FarEndReturn far_end) const {
    std::vector<BarTheory> theories;
    for (const WaveTheory theory : waves) {
      theories.push_back({theory, SolidKind::three_element, far_end});
    }
    return theories;
  }
  [[nodiscard]] std::vector<BarTheory> with_waves(WaveTheory theory) const {
    std::vector<BarTheory> theories;
    for (const FarEndReturn far_end : ends) {
      theories.push_back({theory, SolidKind::three_element, far_end});
    }
    return theories;
  }
};

/// The cheapest theory first: the others, and its other end, begin from where it ended.
void look_at_all(const Open& open, Explanations& explanations) {
  std::vector<BarTheory> theories = open.with_end(open.ends.front());
  const BarTheory cheapest = theories.front();
  explanations.look({cheapest});
  theories.front() = {cheapest.waves, cheapest.solid, open.ends.back()};
  std::rotate(theories.begin(), theories.begin() + 1, theories.end());
  explanations.look(theories);
  const BarTheory* leading = explanations.leading();
  if (leading == nullptr || open.ends.size() == 1) {
    return;
  }
  const WaveTheory waves = leading->waves;
  explanations.look({{waves, SolidKind::three_element, open.ends.back()}});
  for (const BarTheory& theory : open.with_waves(waves)) {
    if (explanations.left_over_noise() > kMoreThanNoise) {
      explanations.look_afresh(theory);
    }
  }
}

/// Whether what a far end returns is told from all and from nothing. Where the model lacks
/// something, one number more may take up some of that and be far ahead, though it says that all
/// comes back: such an end is free.
bool is_a_share(const BarFit& partial) {
  constexpr double kApart = 3.0;
  const FittedNumber& returned = *partial.reflection;
  return std::min(std::abs(returned.value + 1.0), std::abs(returned.value)) > kApart * returned.sd;
}

/// Of an end that returns a share nobody knows: believed where it is far ahead, and where it is,
/// those that return all or nothing are searched once more from there.
const BarFit* or_of_partial_end(const BarFit* best, const Open& open, Explanations& explanations) {
  const BarFit* partial =
      explanations.at_if_better({best->theory, best->solid, FarEndReturn::partial});
  const auto far_ahead = [&] {
    return partial != nullptr && partial->log_evidence > best->log_evidence + kPartialAhead &&
           is_a_share(*partial);
  };
  if (!far_ahead()) {
    return best;
  }
  std::vector<const BarFit*> again;
  for (const BarTheory& theory : open.with_waves(best->theory)) {
    again.push_back(explanations.again(theory, *partial));
  }
  best = best_of(again).fit;
  return far_ahead() ? partial : best;
}

const BarFit* or_lossless(const BarFit* best, Explanations& explanations) {
  if (loss_stands_out(*best)) {
    return best;
  }
  const BarFit* lossless = explanations.lossless_beside(*best);
  return lossless != nullptr && lossless->log_evidence > best->log_evidence ? lossless : best;
}

/// Where the records show what the far end returns, it is asked next whether that is a share.
std::vector<BarTheory> likely_next(const Open& open, const Explanations& explanations) {
  const BarTheory* leading = explanations.leading();
  if (leading == nullptr || open.ends.size() == 1 || open.two_passes) {
    return {};
  }
  for (const BarTheory& theory : open.with_waves(leading->waves)) {
    if (explanations.behind(theory) > 2.0 * kToldApart) {
      return {{leading->waves, leading->solid, FarEndReturn::partial}};
    }
  }
  return {};
}

/// Every theory with the likely end, and the likely one with every end.
std::vector<BarTheory> likely_first(const Open& open, const Explanations& explanations) {
  const BarTheory* leading = explanations.leading();
  if (leading == nullptr) {
    return open.with_end(open.ends.front());
  }
  std::vector<BarTheory> theories = open.with_end(leading->far_end);
  for (const BarTheory& theory : open.with_waves(leading->waves)) {
    if (theory.far_end != leading->far_end) {
      theories.push_back(theory);
    }
  }
  return theories;
}

/// Three elements as the records are evidence for, and what they say of the choice.
const BarFit* choose_three_elements(const BarIdentificationOptions& options, const BarData& data,
                                    Explanations& explanations, BarIdentification& result) {
  const Open open(options, data);
  look_at_all(open, explanations);
  std::vector<const BarFit*> over_theories =
      explanations.at(likely_first(open, explanations), likely_next(open, explanations));
  over_theories.resize(open.waves.size());
  const Best theory = best_of(over_theories);
  if (theory.fit == nullptr) {
    // Says why.
    (void)fit_bar(data, open.with_end(open.ends.front()).front());
    throw InputError("fit", "does not converge", "try another --dispersion or a narrower band");
  }
  result.wave_theory = theory.choice;
  result.wave_theory.asked = options.theory.has_value();
  const std::vector<const BarFit*> over_ends = explanations.at(open.with_waves(theory.fit->theory));
  Best end = best_of(over_ends);
  if (over_ends.front() != nullptr && open.ends.back() == FarEndReturn::partial &&
      (end.choice.ahead < kPartialAhead ||
       (end.fit->far_end == FarEndReturn::partial && !is_a_share(*end.fit)))) {
    end.fit = over_ends.front();
  }
  result.far_end = end.choice;
  result.far_end.asked = options.far_end.has_value();
  const BarFit* best = end.fit;
  if (!options.far_end && !open.two_passes && end.choice.told_apart) {
    best = or_of_partial_end(best, open, explanations);
  }
  return or_lossless(best, explanations);
}

/// Other families than three elements that are to be tried.
std::vector<SolidKind> solids_to_try(const BarIdentificationOptions& options,
                                     const BarFit& three_element) {
  std::vector<SolidKind> solids;
  for (const SolidKind solid :
       {SolidKind::two_kelvin, SolidKind::four_element_fluid, SolidKind::fractional,
        SolidKind::three_kelvin, SolidKind::four_kelvin}) {
    const bool asked = options.solid == solid;
    // Families differ in how they lose: of a bar that loses nothing none is better than another.
    const bool compared = (options.compare_solids || !options.solid) && loss_shows(three_element) &&
                          kelvin_branches(solid) <= 2;
    if (asked || compared) {
      solids.push_back(solid);
    }
  }
  return solids;
}

/// Other families than three elements, and Kelvin branches beyond two for as long as each is
/// clearly ahead of one fewer: whichever family leads so far, since a bar of three branches may be
/// nearer to a fractional one than to two.
Explanations::Solids families_of(const BarFit& three_element, const std::vector<SolidKind>& kinds,
                                 Explanations& explanations) {
  Explanations::Solids solids = explanations.solids(three_element, kinds);
  const auto two = std::ranges::find(kinds, SolidKind::two_kelvin);
  if (solids.three_element.lossless || two == kinds.end()) {
    return solids;
  }
  const auto ahead = [](const BarFit* more, const BarFit& fewer) {
    return more != nullptr && more->log_evidence > fewer.log_evidence + kToldApart;
  };
  const BarFit* fewer = &three_element;
  const BarFit* more = solids.others[static_cast<std::size_t>(two - kinds.begin())];
  while (ahead(more, *fewer)) {
    fewer = more;
    more = explanations.branch_more(three_element, *fewer);
    if (ahead(more, *fewer) && std::ranges::find(solids.others, more) == solids.others.end()) {
      solids.others.push_back(more);
    }
  }
  return solids;
}

double best_evidence(const BarFit& three_element, const Explanations::Solids& solids) {
  double best = three_element.log_evidence;
  for (const BarFit* fit : solids.others) {
    best = fit != nullptr ? std::max(best, fit->log_evidence) : best;
  }
  return best;
}

/// An end that returns a share nobody knows takes up what three elements lack of a bar that has
/// more: another end with another family of solids may be all there is.
struct EndWithSolids {
  const BarFit* three_element = nullptr;
  Explanations::Solids solids;
};
EndWithSolids settle_end(const BarIdentificationOptions& options, const BarData& data,
                         const BarFit& chosen, const std::vector<SolidKind>& kinds,
                         Explanations& explanations) {
  EndWithSolids settled{&chosen, families_of(chosen, kinds, explanations)};
  if (kinds.empty() || options.far_end || data.two_passes() ||
      chosen.far_end != FarEndReturn::partial) {
    return settled;
  }
  const Best whole = best_of(explanations.at(Open(options, data).with_waves(chosen.theory)));
  if (whole.fit == nullptr) {
    return settled;
  }
  EndWithSolids other{whole.fit, families_of(*whole.fit, kinds, explanations)};
  const bool does_as_well = best_evidence(*whole.fit, other.solids) + kPartialAhead >
                            best_evidence(chosen, settled.solids);
  return does_as_well ? std::move(other) : std::move(settled);
}

/// Fills in the fits of three elements, of the solid that is asked for or has the evidence, and of
/// that which has it whatever is asked for.
void choose_solid(const BarIdentificationOptions& options, const BarData& data,
                  const BarFit& at_first, Explanations& explanations, BarIdentification& result) {
  const std::vector<SolidKind> kinds = solids_to_try(options, at_first);
  EndWithSolids settled = settle_end(options, data, at_first, kinds, explanations);
  const BarFit& three_element = *settled.three_element;
  Explanations::Solids& solids = settled.solids;
  result.three_element = solids.three_element;
  result.fit = solids.three_element;
  result.solid.asked = options.solid.has_value();
  if (options.solid && *options.solid != SolidKind::three_element) {
    const auto at = std::find(kinds.begin(), kinds.end(), *options.solid) - kinds.begin();
    const BarFit*& asked = solids.others[static_cast<std::size_t>(at)];
    asked = asked != nullptr ? explanations.finished(theory_of(*asked)) : nullptr;
    result.fit = asked != nullptr
                     ? *asked
                     : fit_bar(data, {three_element.theory, *options.solid, three_element.far_end});
  }
  result.likeliest = result.fit;
  if (!(options.compare_solids || !options.solid) || result.three_element.lossless ||
      !loss_shows(three_element)) {
    return;
  }
  std::vector<const BarFit*>& over_solids = solids.others;
  over_solids.insert(over_solids.begin(), &three_element);
  Best best = best_of(over_solids);
  while (!options.solid && best.fit != &three_element) {
    const auto place = std::find(over_solids.begin(), over_solids.end(), best.fit);
    *place = explanations.finished(theory_of(*best.fit));
    if (*place != nullptr) {
      result.fit = result.likeliest = **place;
      break;
    }
    best = best_of(over_solids);
  }
  if (options.solid && best.fit != nullptr &&
      best.fit->log_evidence > result.fit.log_evidence + kClearlyAhead) {
    const BarFit* likeliest = explanations.finished(theory_of(*best.fit));
    result.likeliest = likeliest != nullptr ? *likeliest : result.fit;
  }
  result.solid.told_apart = best.choice.told_apart;
  result.solid.ahead = best.choice.ahead;
}

}  // namespace

bool loss_shows(const BarFit& three_element) {
  const FittedNumber& E2 = three_element.parameters[1];
  return !three_element.lossless && E2.sd <= kWidestLogOfALoss * E2.value;
}

BarIdentification identify_bar(const std::vector<Shot>& shots,
                               const BarIdentificationOptions& options, const Workers& workers) {
  if (shots.empty()) {
    throw InputError("captures", "are none", "give at least one shot on the bar");
  }
  const BarData data =
      bar_data(shots, options.band_limit_Hz, options.theory.value_or(WaveTheory::elementary));
  Explanations explanations(data, workers);
  BarIdentification result;
  result.two_passes = data.two_passes();
  const BarFit* three_element = choose_three_elements(options, data, explanations, result);
  choose_solid(options, data, *three_element, explanations, result);
  if (result.three_element.lossless) {
    for (BarFit* fit : {&result.three_element, &result.fit, &result.likeliest}) {
      for (std::size_t i = 1; fit->lossless && i < fit->parameters.size(); ++i) {
        fit->parameters[i].sd = fit->parameters[i].value;
      }
    }
  }
  if (!options.theory && !result.wave_theory.told_apart) {
    std::vector<const BarFit*> others;
    for (const BarTheory& theory : Open(options, data).with_end(result.three_element.far_end)) {
      const BarFit* other = explanations.at(theory);
      if (other != nullptr && theory.waves != result.three_element.theory) {
        others.push_back(other);
      }
    }
    take_in(others, result.three_element);
  }
  result.alternatives = explanations.alternatives();
  result.over_shots = over_shots(result.three_element);
  workers.run(2, [&](std::size_t index, std::size_t /*worker*/) {
    if (index == 0) {
      result.spectrum = likely_spectrum(data, result.likeliest);
    } else {
      result.straight_lines = straight_line_spectrum(data, result.likeliest);
    }
  });
  result.paper = three_elements_through(result.straight_lines, kPaperBand_Hz);
  for (const Shot& shot : shots) {
    result.shot_ids.push_back(shot.id);
  }
  result.temperature_K = mean_temperature_K(shots);
  result.warnings = warnings_of(result, shots, data);
  return result;
}

}  // namespace kolsky
