#include "processing/reduction/loop_summary.hpp"

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

namespace kolsky {

namespace {

constexpr double kLoadingStart = 0.05;  // of the peak stress
constexpr double kLoadingEnd = 0.98;    // of the largest strain

constexpr double kRisen = 0.2;    // of the largest of all, so as to be no ripple at the start
constexpr double kFallen = 0.9;   // of the largest so far: the specimen unloads
constexpr double kNoForce = 0.1;  // of the largest so far

std::size_t index_of_largest(std::span<const double> history) {
  return static_cast<std::size_t>(std::max_element(history.begin(), history.end()) -
                                  history.begin());
}

/// In what sense the specimen is loaded at first, not most: what pulls at it later may be stronger.
double sense_of(const std::vector<double>& stress_Pa) {
  double largest = 0.0;
  for (const double stress : stress_Pa) {
    largest = std::max(largest, std::abs(stress));
  }
  const auto risen = std::find_if(stress_Pa.begin(), stress_Pa.end(), [&](double stress) {
    return std::abs(stress) > kRisen * largest;
  });
  return risen != stress_Pa.end() && *risen < 0.0 ? -1.0 : 1.0;
}

/// Samples until the first loading and its unloading are over, or the strain has clearly come back.
/// A specimen that keeps its strain is unloaded when hardly any force is left on it.
std::size_t first_pass(const Reduction& r, double sense) {
  double largest = 0.0;
  for (const double strain : r.strain) {
    largest = std::max(largest, sense * strain);
  }
  double most = 0.0;
  double most_Pa = 0.0;
  for (std::size_t n = 0; n < r.strain.size(); ++n) {
    const double strain = sense * r.strain[n];
    most = std::max(most, strain);
    most_Pa = std::max(most_Pa, sense * r.stress_Pa[n]);
    const bool unloaded = strain < most && sense * r.stress_Pa[n] < kNoForce * most_Pa;
    if (most > kRisen * largest && (strain < kFallen * most || unloaded)) {
      return n;
    }
  }
  return r.strain.size();
}

// The last sample before `peak` at which the history is still below the level.
std::size_t rise_before(std::span<const double> history, std::size_t peak, double level) {
  std::size_t i = peak;
  while (i > 0 && history[i] >= level) {
    --i;
  }
  return i;
}

std::size_t first_at(std::span<const double> history, double level) {
  return static_cast<std::size_t>(
      std::find_if(history.begin(), history.end(), [&](double value) { return value >= level; }) -
      history.begin());
}

}  // namespace

std::size_t loading_end(const Reduction& reduction) {
  if (reduction.strain.empty()) {
    return 0;
  }
  const double sense = sense_of(reduction.stress_Pa);
  const auto begin = reduction.strain.begin();
  const auto end = begin + static_cast<std::ptrdiff_t>(first_pass(reduction, sense));
  const auto furthest = sense < 0.0 ? std::min_element(begin, end) : std::max_element(begin, end);
  return static_cast<std::size_t>(furthest - begin) + 1;
}

LoopSummary summarise(const Reduction& reduction) {
  if (reduction.stress_Pa.empty()) {
    return {};
  }
  const std::size_t peak = index_of_largest(reduction.stress_Pa);
  LoopSummary summary;
  summary.peak_stress_Pa = reduction.stress_Pa[peak];
  summary.strain_at_peak = reduction.strain[peak];
  summary.peak_strain = reduction.strain[index_of_largest(reduction.strain)];
  const std::size_t pass = first_pass(reduction, 1.0);
  const auto stress_Pa = std::span(reduction.stress_Pa).first(pass);
  const auto strain = std::span(reduction.strain).first(pass);
  const std::size_t most = index_of_largest(stress_Pa);
  const std::size_t begin = rise_before(stress_Pa, most, kLoadingStart * stress_Pa[most]);
  const std::size_t end = first_at(strain, kLoadingEnd * strain[index_of_largest(strain)]);
  if (end > begin && end < strain.size()) {
    summary.loading_s = reduction.time_s[end] - reduction.time_s[begin];
    summary.mean_strain_rate_per_s = (strain[end] - strain[begin]) / summary.loading_s;
  }
  return summary;
}

}  // namespace kolsky
