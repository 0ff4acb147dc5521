#include "processing/identification/explanations.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "processing/base/error.hpp"

namespace kolsky {

namespace {

/// In chi2 of all shots as one. A closer search and other weights move what a theory is behind by
/// some percent of itself; to be told apart takes 10.
constexpr double kFarBehind = 400.0;
constexpr double kNoWorse = 1.0;
/// What another parameter must gain to be believed is ten times as much; less than this by a
/// rough search does not become that by a closer one.
constexpr double kNoBetter = 3.0;

/// A solid that three elements nearly are, as logarithms: a little away from them, where what it
/// has more still shows.
std::vector<double> near_three_elements(SolidKind solid, const std::vector<double>& logs) {
  const double E1 = logs[0];
  const double E2 = logs[1];
  const double eta2 = logs[2];
  // Of a bar without loss eta2 can be anything.
  const double slow = E2 + std::log(100.0 * kTypicalTime_s);
  const double fast = E2 + std::log(kTypicalTime_s);
  switch (solid) {
    case SolidKind::three_element:
      break;
    case SolidKind::four_element_fluid:
      return {E1, slow, E2, eta2};
    case SolidKind::two_kelvin:
      return {E1, E2, eta2, E2 + std::log(10.0), slow};
    case SolidKind::three_kelvin:
      return {E1, E2, eta2, E2 + std::log(10.0), slow, E2 + std::log(10.0), fast};
    case SolidKind::four_kelvin: {
      const double between = E2 + std::log(10.0 * kTypicalTime_s);
      const double weak = E2 + std::log(10.0);
      return {E1, E2, eta2, weak, slow, weak, fast, weak, between};
    }
    case SolidKind::fractional:
      return {E1, E2, eta2, std::log(0.98)};
  }
  return logs;
}

/// Kelvin branches, as logarithms, with a weak one more: ten times faster than the fastest of them,
/// between any two neighbours in time, and ten times slower than the slowest.
std::vector<std::vector<double>> with_branch_more(const std::vector<double>& at,
                                                  std::size_t branches) {
  const double away = std::log(10.0);
  const auto end = static_cast<std::ptrdiff_t>(1 + 2 * branches);
  std::vector<double> log_times;
  double weakest = at[1];
  for (std::size_t i = 1; i < static_cast<std::size_t>(end); i += 2) {
    log_times.push_back(at[i + 1] - at[i]);
    weakest = std::max(weakest, at[i]);
  }
  std::ranges::sort(log_times);
  std::vector<double> places{log_times.front() - away};
  for (std::size_t i = 1; i < log_times.size(); ++i) {
    places.push_back(0.5 * (log_times[i - 1] + log_times[i]));
  }
  places.push_back(log_times.back() + away);
  std::vector<std::vector<double>> starts;
  for (const double log_time : places) {
    const double E = weakest + away;
    std::vector<double>& start = starts.emplace_back(at);
    start.insert(start.begin() + end, {E, E + log_time});
  }
  return starts;
}

void by_own_weights(BarSearch& search) {
  search.closely();
}

double chi2_of(const BarFit& fit) {
  return fit.chi2_reduced * static_cast<double>(fit.degrees_of_freedom);
}

}  // namespace

Explanations::Entry* Explanations::find(const BarTheory& theory) {
  for (const auto& entry : entries_) {
    if (entry->theory == theory) {
      return entry.get();
    }
  }
  return nullptr;
}

Explanations::Entry& Explanations::add(const BarTheory& theory) {
  const Entry* near = nearest(theory);
  entries_.push_back(std::make_unique<Entry>());
  entries_.back()->theory = theory;
  entries_.back()->near = near;
  return *entries_.back();
}

/// The best of those with the same parameters.
const Explanations::Entry* Explanations::nearest(const BarTheory& theory) const {
  const Entry* near = nullptr;
  for (const auto& entry : entries_) {
    const bool same = entry->search && entry->theory.solid == theory.solid &&
                      entry->theory.lossless == theory.lossless &&
                      (entry->theory.far_end == FarEndReturn::partial) ==
                          (theory.far_end == FarEndReturn::partial);
    if (same && (near == nullptr || entry->rough_chi2 < near->rough_chi2)) {
      near = entry.get();
    }
  }
  return near;
}

void Explanations::start_roughly(Entry& entry) {
  if (entry.near != nullptr) {
    search_roughly(entry, entry.near->search->at(), hopeless());
  }
  if (!entry.search) {
    search_roughly(entry, {});
    search_from_filed(entry);
  }
}

/// Pulses hardly out of their noise rise anywhere: a search from their speed ends a period off.
void Explanations::search_from_filed(Entry& entry) {
  constexpr double kLeavesMuch = 1.5;
  const auto& filed_Pa = data_.bench().input.youngs_modulus_Pa;
  if (filed_Pa && entry.search && entry.theory.solid == SolidKind::three_element &&
      entry.rough_chi2 > kLeavesMuch * expected_chi2()) {
    search_roughly(entry, elastic_start(entry.search->at(), *filed_Pa));
  }
}

Explanations::Entry& Explanations::rough(const BarTheory& theory) {
  if (Entry* known = find(theory)) {
    return *known;
  }
  Entry& entry = add(theory);
  start_roughly(entry);
  return entry;
}

void Explanations::search_roughly(Entry& entry, const std::vector<double>& start, double hopeless) {
  try {
    auto search = rough_search(data_, entry.theory, start, hopeless);
    if (!entry.search || search->rough_chi2() < entry.rough_chi2) {
      entry.rough_chi2 = search->rough_chi2();
      entry.search = std::move(search);
      entry.failed.clear();
    }
  } catch (const InputError& error) {
    if (!entry.search) {
      entry.failed = error.problem();
    }
  }
}

std::vector<Explanations::Entry*> Explanations::add_new(const std::vector<BarTheory>& theories) {
  std::vector<Entry*> added;
  for (const BarTheory& theory : theories) {
    if (find(theory) == nullptr) {
      added.push_back(&add(theory));
    }
  }
  return added;
}

void Explanations::look(const std::vector<BarTheory>& theories) {
  const std::vector<Entry*> added = add_new(theories);
  workers_.run(added.size(),
               [&](std::size_t index, std::size_t /*worker*/) { start_roughly(*added[index]); });
  for (const BarTheory& theory : theories) {
    lead_with(*find(theory));
  }
}

void Explanations::look_afresh(const BarTheory& theory) {
  Entry& entry = rough(theory);
  search_roughly(entry, {});
  lead_with(entry);
}

void Explanations::lead_with(Entry& entry) {
  if (entry.search && (leader_ == nullptr || entry.rough_chi2 < leader_->rough_chi2)) {
    leader_ = &entry;
  }
}

/// So far behind the leading one that a closer search would leave it there.
double Explanations::hopeless() const {
  constexpr double kFarther = 10.0;
  return leader_ != nullptr
             ? leader_->rough_chi2 + kFarther * kFarBehind * std::max(1.0, left_over_noise())
             : HUGE_VAL;
}

double Explanations::left_over_noise() const {
  return leader_->rough_chi2 / expected_chi2();
}

/// Of noise alone, all shots as one.
double Explanations::expected_chi2() const {
  return static_cast<double>(data_.judged_path().size()) * 2.0 *
         static_cast<double>(data_.gauges() - 1);
}

double Explanations::behind(const BarTheory& theory) const {
  for (const auto& entry : entries_) {
    if (entry->theory == theory && entry->search && leader_ != nullptr) {
      return entry->rough_chi2 - leader_->rough_chi2;
    }
  }
  return 0.0;
}

const BarTheory* Explanations::leading() const {
  return leader_ != nullptr ? &leader_->theory : nullptr;
}

bool Explanations::far_behind(const Entry& entry) const {
  return entry.rough_chi2 > leader_->rough_chi2 + kFarBehind * std::max(1.0, left_over_noise());
}

void Explanations::compare(Entry& entry, const std::function<void(BarSearch&)>& closely) {
  try {
    closely(*entry.search);
    entry.fit = entry.search->so_far();
  } catch (const InputError& error) {
    entry.failed = error.problem();
    entry.search.reset();
  }
}

void Explanations::compare(Entry& entry) {
  if (!entry.search || leader_ == nullptr || entry.fit) {
    return;
  }
  entry.left_behind = far_behind(entry);
  if (entry.left_behind) {
    entry.fit = entry.search->so_far();
    return;
  }
  compare(entry, by_own_weights);
  if (!entry.fit && may_be_elastic(entry.theory)) {
    try_from(entry, search_from_elastic);
  }
}

std::vector<const BarFit*> Explanations::at(const std::vector<BarTheory>& theories,
                                            const std::vector<BarTheory>& next) {
  std::vector<Entry*> entries;
  for (const BarTheory& theory : theories) {
    entries.push_back(&rough(theory));
  }
  const std::vector<Entry*> added = add_new(next);
  const std::size_t compared = entries.size();
  workers_.run(compared + added.size(), [&](std::size_t index, std::size_t /*worker*/) {
    if (index < compared) {
      compare(*entries[index]);
    } else {
      start_roughly(*added[index - compared]);
    }
  });
  std::vector<const BarFit*> fits;
  for (const Entry* entry : entries) {
    fits.push_back(entry->fit ? &*entry->fit : nullptr);
  }
  return fits;
}

const BarFit* Explanations::at_if_better(const BarTheory& theory) {
  Entry& entry = rough(theory);
  if (entry.search && !entry.fit && leader_ != nullptr &&
      entry.rough_chi2 > leader_->rough_chi2 - kNoBetter) {
    entry.left_behind = true;
    return nullptr;
  }
  return at(theory);
}

void Explanations::compare_from(Entry& entry, const BarFit& three_element,
                                const BarLikelihood::Weights& weights) {
  const auto solid = three_element.at.begin() +
                     static_cast<std::ptrdiff_t>(parameters_of(SolidKind::three_element).size());
  std::vector<double> start =
      near_three_elements(entry.theory.solid, {three_element.at.begin(), solid});
  start.insert(start.end(), solid, three_element.at.end());
  entry.search = std::make_unique<BarSearch>(data_, entry.theory);
  compare(entry, [&](BarSearch& search) { search.closely(start, weights); });
  // It holds three elements within it, so that it cannot be worse: but its search can.
  if (!entry.fit || chi2_of(*entry.fit) > chi2_of(three_element) + kNoWorse) {
    try_from(entry, [](const BarData& data, const BarTheory& other) {
      return rough_search(data, other, {});
    });
  }
}

Explanations::Solids Explanations::solids(const BarFit& three_element,
                                          const std::vector<SolidKind>& others) {
  Entry& held = *find(
      {three_element.theory, three_element.solid, three_element.far_end, three_element.lossless});
  // By the same weights: what holds three elements must not look worse for where it was weighed.
  const BarLikelihood::Weights weights = held.search->weights();
  std::vector<Entry*> entries;
  for (const SolidKind solid : others) {
    entries.push_back(&add({three_element.theory, solid, three_element.far_end}));
  }
  Solids result;
  const BarFit start = three_element;
  std::optional<BarFit> to_end;
  // The longest first.
  workers_.run(1 + entries.size(), [&](std::size_t index, std::size_t /*worker*/) {
    if (index == 0) {
      to_end = if_it_ends(held);
    } else {
      compare_from(*entries[index - 1], start, weights);
    }
  });
  if (!to_end) {
    result.three_element = without_loss(held.theory);
    result.others.resize(entries.size());
    return result;
  }
  result.three_element = std::move(*to_end);
  for (const Entry* entry : entries) {
    result.others.push_back(entry->fit ? &*entry->fit : nullptr);
  }
  return result;
}

const BarFit* Explanations::branch_more(const BarFit& three_element, const BarFit& fewer) {
  const auto solid = one_branch_more(fewer.solid);
  if (!solid) {
    return nullptr;
  }
  const BarTheory theory{fewer.theory, *solid, fewer.far_end};
  Entry* const known = find(theory);
  Entry& entry = known != nullptr ? *known : add(theory);
  const BarLikelihood::Weights& weights =
      find({three_element.theory, three_element.solid, three_element.far_end})->search->weights();
  const auto starts = with_branch_more(fewer.at, kelvin_branches(fewer.solid));
  std::vector<Entry> others(starts.size());
  workers_.run(starts.size(), [&](std::size_t index, std::size_t /*worker*/) {
    Entry& other = others[index];
    other.theory = theory;
    other.rough_chi2 = entry.rough_chi2;
    other.search = std::make_unique<BarSearch>(data_, theory);
    compare(other, [&](BarSearch& search) { search.closely(starts[index], weights); });
  });
  for (Entry& other : others) {
    if (!entry.fit || (other.fit && other.fit->log_evidence > entry.fit->log_evidence)) {
      entry = std::move(other);
    }
  }
  return entry.fit ? &*entry.fit : nullptr;
}

const BarFit* Explanations::lossless_beside(const BarFit& lossy) {
  constexpr double kWithin = 0.25;  // of the band: where pulses have most of their power
  const BarTheory theory{lossy.theory, lossy.solid, lossy.far_end, true};
  const BarFit* fit = at(theory);
  if (fit == nullptr || chi2_of(*fit) > chi2_of(lossy) + kFarBehind) {
    const auto solid = make_solid(lossy.solid, values_of(lossy.parameters));
    const Complex s(0.0, 2.0 * std::numbers::pi * kWithin * lossy.band_limit_Hz);
    const std::vector<double> start = elastic_start(lossy.at, 1.0 / std::abs(solid->at(s)));
    try_from(*find(theory), [&](const BarData& data, const BarTheory& other) {
      return rough_search(data, other, start);
    });
    fit = find(theory)->fit ? &*find(theory)->fit : nullptr;
  }
  return fit;
}

const BarFit* Explanations::again(const BarTheory& theory, const BarFit& partial) {
  Entry& entry = *find(theory);
  std::vector<double> start = partial.at;
  start.erase(start.begin() + static_cast<std::ptrdiff_t>(parameters_of(theory.solid).size()));
  try_from(entry, [&](const BarData& data, const BarTheory& other) {
    return rough_search(data, other, start);
  });
  return entry.fit ? &*entry.fit : nullptr;
}

void Explanations::try_from(Entry& entry, const Start& start) {
  Entry other;
  other.theory = entry.theory;
  other.rough_chi2 = entry.rough_chi2;
  try {
    other.search = start(data_, entry.theory);
    compare(other, by_own_weights);
  } catch (const InputError& error) {
    other.failed = error.problem();
  }
  if (!entry.fit || (other.fit && other.fit->log_evidence > entry.fit->log_evidence)) {
    entry = std::move(other);
  }
}

const BarFit* Explanations::finished(const BarTheory& theory) {
  Entry& entry = *find(theory);
  try {
    entry.fit = searched_to_end(entry);
    return &*entry.fit;
  } catch (const InputError& error) {
    entry.fit.reset();
    entry.failed = error.problem();
    return nullptr;
  }
}

/// Nothing where a loss that does not stand out of the noise is sought without end.
std::optional<BarFit> Explanations::if_it_ends(Entry& entry) {
  try {
    return searched_to_end(entry);
  } catch (const InputError&) {
    if (!may_be_elastic(entry.theory)) {
      throw;
    }
    return std::nullopt;
  }
}

BarFit Explanations::without_loss(BarTheory theory) {
  theory.lossless = true;
  if (at(theory) == nullptr) {
    throw InputError("fit", find(theory)->failed, "try another --dispersion or a narrower band");
  }
  return searched_to_end(*find(theory));
}

BarFit Explanations::searched_to_end(Entry& entry) {
  BarFit fit;
  try {
    fit = entry.search->finished();
  } catch (const InputError&) {
    if (!may_be_elastic(entry.theory)) {
      throw;
    }
    entry.search = search_from_elastic(data_, entry.theory);
    entry.search->closely();
    fit = entry.search->finished();
  }
  fit.log_evidence = entry.fit->log_evidence;
  return fit;
}

/// Of one left at a rough search: as far from the leading one as that found it, with one number
/// more.
Alternative Explanations::left_roughly(const Entry& entry) const {
  Alternative alternative;
  if (leader_->fit) {
    const auto freedom = static_cast<double>(leader_->fit->degrees_of_freedom);
    const double gain = leader_->rough_chi2 - entry.rough_chi2;
    alternative.log_evidence = leader_->fit->log_evidence + 0.5 * (gain - std::log(freedom));
    alternative.chi2_reduced = leader_->fit->chi2_reduced - gain / freedom;
  }
  return alternative;
}

std::vector<Alternative> Explanations::alternatives() const {
  std::vector<Alternative> list;
  for (const auto& entry : entries_) {
    if (!entry->fit && !entry->left_behind && entry->failed.empty()) {
      continue;
    }
    Alternative alternative;
    if (entry->fit) {
      alternative.log_evidence = entry->fit->log_evidence;
      alternative.chi2_reduced = entry->fit->chi2_reduced;
    } else if (entry->left_behind) {
      alternative = left_roughly(*entry);
    }
    alternative.theory = entry->theory;
    alternative.left_behind = entry->left_behind;
    alternative.failed = entry->failed;
    list.push_back(std::move(alternative));
  }
  std::stable_sort(list.begin(), list.end(), [](const Alternative& a, const Alternative& b) {
    return a.failed.empty() != b.failed.empty() ? a.failed.empty()
                                                : a.log_evidence > b.log_evidence;
  });
  return list;
}

}  // namespace kolsky
