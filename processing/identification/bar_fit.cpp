#include "processing/identification/bar_fit.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "processing/base/error.hpp"
#include "processing/identification/bar_search.hpp"

namespace kolsky {

namespace {

BarFit search(const BarData& data, const BarTheory& theory, const std::vector<double>& start) {
  BarSearch search(data, theory);
  search.roughly(start);
  search.closely();
  return search.finished();
}

}  // namespace

std::vector<double> values_of(const std::vector<FittedNumber>& numbers) {
  std::vector<double> values;
  for (const FittedNumber& number : numbers) {
    values.push_back(number.value);
  }
  return values;
}

std::vector<std::string> names_of(const std::vector<FittedNumber>& numbers) {
  std::vector<std::string> names;
  for (const FittedNumber& number : numbers) {
    names.push_back(number.name);
  }
  return names;
}

std::vector<Measured> measured_of(const std::vector<FittedNumber>& numbers) {
  std::vector<Measured> measured;
  for (const FittedNumber& number : numbers) {
    measured.push_back({number.value, number.sd});
  }
  return measured;
}

std::vector<double> row_by_row(const std::vector<std::vector<double>>& matrix) {
  std::vector<double> numbers;
  for (const std::vector<double>& row : matrix) {
    numbers.insert(numbers.end(), row.begin(), row.end());
  }
  return numbers;
}

std::vector<double> first_guess(const BarData& data, SolidKind solid) {
  constexpr double kLeastTangent = 1e-4;
  constexpr double kMostTangent = 0.3;
  constexpr double kTypicalFrequency_Hz = 5e3;
  const BarRecords& records = data.records().front();
  const double span_m = records.position_m.back() - records.position_m.front();
  const double time_s = records.rise_s.back() - records.rise_s.front();
  if (time_s <= 0.0) {
    throw InputError("gauges", "see the pulse in another order than they lie along the bar",
                     "give positions from the impacted end, gauges in the order of the channels, "
                     "and records that begin before the pulse passes the first");
  }
  const double speed = span_m / time_s;
  const double E1 = data.bench().input.density_kg_m3 * speed * speed;
  const double decay_per_m = std::log(records.peak.front() / records.peak.back()) / span_m;
  const double wavenumber = 2.0 * std::numbers::pi * kTypicalFrequency_Hz / speed;
  const double tangent = std::clamp(2.0 * decay_per_m / wavenumber, kLeastTangent, kMostTangent);
  const double E2 = E1 / (2.0 * tangent);
  const double eta2 = E2 * kTypicalTime_s;
  std::vector<double> guess;
  switch (solid) {
    case SolidKind::three_element:
      guess = {E1, E2, eta2};
      break;
    case SolidKind::four_element_fluid:
      guess = {E1, 100.0 * eta2, E2, eta2};
      break;
    case SolidKind::two_kelvin:
      guess = {E1, 2.0 * E2, eta2, 2.0 * E2, 10.0 * eta2};
      break;
    case SolidKind::three_kelvin:
      guess = {E1, 3.0 * E2, 0.3 * eta2, 3.0 * E2, 3.0 * eta2, 3.0 * E2, 30.0 * eta2};
      break;
    case SolidKind::four_kelvin:
      guess = {E1,       4.0 * E2,    0.4 * eta2, 4.0 * E2,    4.0 * eta2,
               4.0 * E2, 40.0 * eta2, 4.0 * E2,   400.0 * eta2};
      break;
    case SolidKind::fractional:
      guess = {E1, E2, eta2, 0.9};
      break;
  }
  std::transform(guess.begin(), guess.end(), guess.begin(), [](double x) { return std::log(x); });
  return guess;
}

BarFit fit_bar(const BarData& data, const BarTheory& theory, const std::vector<double>& start) {
  try {
    return search(data, theory, start);
  } catch (const InputError&) {
    if (theory.solid != SolidKind::three_element || theory.lossless) {
      throw;
    }
  }
  BarTheory elastic = theory;
  elastic.lossless = true;
  return search(data, theory, search(data, elastic, {}).at);
}

BarData bar_data(const std::vector<Shot>& shots, double band_limit_Hz, WaveTheory theory) {
  constexpr int kMostRounds = 8;
  constexpr double kSettled = 0.1;  // of a deviation
  constexpr double kSeen = 0.3;
  BarData data(shots, band_limit_Hz);
  std::vector<FittedNumber> before;
  const auto moved = [&](const std::vector<FittedNumber>& now) {
    for (std::size_t i = 0; i < before.size(); ++i) {
      if (std::abs(now[i].value - before[i].value) > kSettled * now[i].sd) {
        return true;
      }
    }
    return before.empty();
  };
  int rounds = 0;
  for (bool settled = !data.two_passes(); !settled;) {
    // What the far end returns is not known yet, and would else be taken for loss.
    const std::vector<FittedNumber> found =
        fit_bar(data, {.waves = theory, .far_end = FarEndReturn::partial}).parameters;
    settled = ++rounds == kMostRounds || !moved(found);
    // A loss that does not stand out of the noise would make up a tail of its own.
    const bool lossy = found[1].sd < kSeen * found[1].value;
    const auto solid = make_solid(SolidKind::three_element, values_of(found));
    const ElasticSolid elastic(found[0].value);
    data =
        BarData(shots, band_limit_Hz, {.solid = lossy ? solid.get() : &elastic, .judged = settled});
    before = found;
  }
  return data;
}

BarFit fit_bar(const std::vector<Shot>& shots, const BarFitOptions& options) {
  if (shots.empty()) {
    throw InputError("captures", "are none", "give at least one shot on the bar");
  }
  BarData data = bar_data(shots, options.band_limit_Hz, options.theory);
  return fit_bar(data, {options.theory, options.solid, options.far_end});
}

}  // namespace kolsky
