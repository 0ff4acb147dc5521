#include "processing/reduction/loop_summary.hpp"

#include <algorithm>
#include <cmath>

namespace kolsky {

namespace {

constexpr double kLoadingStart = 0.05;  // of the peak stress
constexpr double kLoadingEnd = 0.98;    // of the largest strain

std::size_t index_of_largest(const std::vector<double>& history) {
  return static_cast<std::size_t>(std::max_element(history.begin(), history.end()) -
                                  history.begin());
}

// The last sample before `peak` at which the history is still below the level.
std::size_t rise_before(const std::vector<double>& history, std::size_t peak, double level) {
  std::size_t i = peak;
  while (i > 0 && history[i] >= level) {
    --i;
  }
  return i;
}

std::size_t first_at(const std::vector<double>& history, double level) {
  return static_cast<std::size_t>(
      std::find_if(history.begin(), history.end(), [&](double value) { return value >= level; }) -
      history.begin());
}

}  // namespace

std::size_t loading_end(const Reduction& reduction) {
  if (reduction.strain.empty()) {
    return 0;
  }
  const auto smaller = [](double a, double b) { return std::abs(a) < std::abs(b); };
  const auto stress =
      std::max_element(reduction.stress_Pa.begin(), reduction.stress_Pa.end(), smaller);
  const bool tensile = stress != reduction.stress_Pa.end() && *stress < 0.0;
  const auto& strain = reduction.strain;
  const auto furthest = tensile ? std::min_element(strain.begin(), strain.end())
                                : std::max_element(strain.begin(), strain.end());
  return static_cast<std::size_t>(furthest - strain.begin()) + 1;
}

LoopSummary summarise(const Reduction& reduction) {
  if (reduction.stress_Pa.empty()) {
    return {};
  }
  const std::size_t peak = index_of_largest(reduction.stress_Pa);
  const std::size_t furthest = index_of_largest(reduction.strain);
  LoopSummary summary;
  summary.peak_stress_Pa = reduction.stress_Pa[peak];
  summary.strain_at_peak = reduction.strain[peak];
  summary.peak_strain = reduction.strain[furthest];
  const std::size_t begin =
      rise_before(reduction.stress_Pa, peak, kLoadingStart * summary.peak_stress_Pa);
  const std::size_t end = first_at(reduction.strain, kLoadingEnd * summary.peak_strain);
  if (end > begin && end < reduction.strain.size()) {
    summary.loading_s = reduction.time_s[end] - reduction.time_s[begin];
    summary.mean_strain_rate_per_s =
        (reduction.strain[end] - reduction.strain[begin]) / summary.loading_s;
  }
  return summary;
}

}  // namespace kolsky
