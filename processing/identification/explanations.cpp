#include "processing/identification/explanations.hpp"

#include <algorithm>
#include <cmath>

#include "processing/base/error.hpp"

namespace kolsky {

namespace {

/// In chi2 of all shots as one. A closer search and other weights move what a theory is behind by
/// some percent of itself; to be told apart takes 10.
constexpr double kFarBehind = 400.0;
constexpr double kNoWorse = 1.0;

/// A solid that three elements nearly are, as logarithms: a little away from them, where what it
/// has more still shows.
std::vector<double> near_three_elements(SolidKind solid, const std::vector<double>& logs) {
  const double E1 = logs[0];
  const double E2 = logs[1];
  const double eta2 = logs[2];
  // Of a bar without loss eta2 can be anything.
  const double slow = E2 + std::log(100.0 * kTypicalTime_s);
  switch (solid) {
    case SolidKind::three_element:
      break;
    case SolidKind::four_element_fluid:
      return {E1, slow, E2, eta2};
    case SolidKind::two_kelvin:
      return {E1, E2, eta2, E2 + std::log(10.0), slow};
    case SolidKind::fractional:
      return {E1, E2, eta2, std::log(0.98)};
  }
  return logs;
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
  entries_.push_back(std::make_unique<Entry>());
  entries_.back()->theory = theory;
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

Explanations::Entry& Explanations::rough(const BarTheory& theory) {
  if (Entry* known = find(theory)) {
    return *known;
  }
  const Entry* near = nearest(theory);
  Entry& entry = add(theory);
  if (near != nullptr) {
    search_roughly(entry, near->search->at());
  }
  if (!entry.search) {
    search_roughly(entry, {});
  }
  return entry;
}

void Explanations::search_roughly(Entry& entry, const std::vector<double>& start) {
  try {
    auto search = rough_search(data_, entry.theory, start);
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

void Explanations::look(const BarTheory& theory) {
  lead_with(rough(theory));
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

double Explanations::left_over_noise() const {
  const double expected = static_cast<double>(data_.judged_path().size()) * 2.0 *
                          static_cast<double>(data_.gauges() - 1);
  return leader_->rough_chi2 / expected;
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

const BarFit* Explanations::at(const BarTheory& theory) {
  Entry& entry = rough(theory);
  if (entry.search && leader_ != nullptr && !entry.fit) {
    entry.left_behind = far_behind(entry);
    if (entry.left_behind) {
      entry.fit = entry.search->so_far();
    } else {
      compare(entry, by_own_weights);
      if (!entry.fit && may_be_elastic(theory)) {
        try_from(entry, search_from_elastic);
      }
    }
  }
  return entry.fit ? &*entry.fit : nullptr;
}

const BarFit* Explanations::at(const BarTheory& theory, const BarFit& three_element) {
  Entry* entry = find(theory);
  if (entry == nullptr) {
    entry = &add(theory);
    entry->search = std::make_unique<BarSearch>(data_, theory);
    const auto solid = three_element.at.begin() +
                       static_cast<std::ptrdiff_t>(parameters_of(SolidKind::three_element).size());
    std::vector<double> start =
        near_three_elements(theory.solid, {three_element.at.begin(), solid});
    start.insert(start.end(), solid, three_element.at.end());
    // By the same weights: what holds three elements must not look worse for where it was weighed.
    const BarTheory held{three_element.theory, three_element.solid, three_element.far_end};
    const auto weights = find(held)->search->weights();
    compare(*entry, [&](BarSearch& search) { search.closely(start, weights); });
    // It holds three elements within it, so that it cannot be worse: but its search can.
    if (!entry->fit || chi2_of(*entry->fit) > chi2_of(three_element) + kNoWorse) {
      try_from(*entry, [](const BarData& data, const BarTheory& other) {
        return rough_search(data, other, {});
      });
    }
  }
  return entry->fit ? &*entry->fit : nullptr;
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

BarFit Explanations::finished(const BarTheory& theory) {
  Entry& entry = *find(theory);
  BarFit fit;
  try {
    fit = entry.search->finished();
  } catch (const InputError&) {
    if (!may_be_elastic(theory)) {
      throw;
    }
    entry.search = search_from_elastic(data_, theory);
    entry.search->closely();
    fit = entry.search->finished();
  }
  fit.log_evidence = entry.fit->log_evidence;
  return fit;
}

std::vector<Alternative> Explanations::alternatives() const {
  std::vector<Alternative> list;
  for (const auto& entry : entries_) {
    if (!entry->fit && entry->failed.empty()) {
      continue;
    }
    Alternative& alternative = list.emplace_back();
    alternative.theory = entry->theory;
    alternative.left_behind = entry->left_behind;
    alternative.failed = entry->failed;
    if (entry->fit) {
      alternative.log_evidence = entry->fit->log_evidence;
      alternative.chi2_reduced = entry->fit->chi2_reduced;
    }
  }
  std::stable_sort(list.begin(), list.end(), [](const Alternative& a, const Alternative& b) {
    return a.failed.empty() != b.failed.empty() ? a.failed.empty()
                                                : a.log_evidence > b.log_evidence;
  });
  return list;
}

}  // namespace kolsky
