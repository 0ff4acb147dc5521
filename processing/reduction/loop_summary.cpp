#include "processing/reduction/loop_summary.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <span>
#include <vector>

#include "processing/reduction/formatted.hpp"

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
/// Told by the push so far, which a spike or a ripple at the start hardly adds to.
double sense_of(const std::vector<double>& stress_Pa) {
  constexpr double kPushed = 0.1;  // of the largest push
  std::vector<double> push(stress_Pa.size());
  std::partial_sum(stress_Pa.begin(), stress_Pa.end(), push.begin());
  double largest = 0.0;
  for (const double so_far : push) {
    largest = std::max(largest, std::abs(so_far));
  }
  const auto pushed = std::ranges::find_if(
      push, [&](double so_far) { return std::abs(so_far) > kPushed * largest; });
  return pushed != push.end() && *pushed < 0.0 ? -1.0 : 1.0;
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

/// Where the histories hold the stretch over which a loading is measured.
struct Loading {
  std::size_t begin = 0, end = 0;
  std::string missing;  ///< why they do not; empty where they do
};

bool push_hidden(const Quality& quality) {
  const Check* overlap = quality.find("window_overlap");
  return overlap != nullptr && overlap->verdict == Verdict::fail;
}

bool sign_is_wrong(const Quality& quality) {
  const Check* sign = quality.find("gauge_sign");
  return sign != nullptr && sign->verdict == Verdict::fail;
}

/// A history counted positive in the sense of the loading.
std::vector<double> in_sense(std::span<const double> history, double sense) {
  std::vector<double> turned(history.begin(), history.end());
  std::ranges::for_each(turned, [sense](double& value) { value *= sense; });
  return turned;
}

Loading loading_of(const Reduction& r, double sense) {
  const std::size_t pass = first_pass(r, sense);
  const std::vector<double> stress_Pa = in_sense(std::span(r.stress_Pa).first(pass), sense);
  const std::vector<double> strain = in_sense(std::span(r.strain).first(pass), sense);
  if (pass == 0) {
    return {0, 0, "the specimen is nowhere loaded"};
  }
  const double peak_Pa = stress_Pa[index_of_largest(stress_Pa)];
  const double most = strain[index_of_largest(strain)];
  if (peak_Pa <= 0.0) {
    return {0, 0, "there is nowhere any stress"};
  }
  if (most <= 0.0) {
    return {0, 0,
            formatted("the specimen is nowhere %s", sense < 0.0 ? "lengthened" : "shortened")};
  }
  // A step may begin so; of a hidden push it is what the separation made of it.
  if (push_hidden(r.quality) && stress_Pa.front() > kRisen * peak_Pa) {
    return {0, 0,
            formatted("the histories begin at %.0f %% of the largest stress",
                      100.0 * stress_Pa.front() / peak_Pa)};
  }
  Loading loading{rise_before(stress_Pa, index_of_largest(stress_Pa), kLoadingStart * peak_Pa),
                  first_at(strain, kLoadingEnd * most), ""};
  if (loading.end <= loading.begin) {
    loading.missing = "the strain is largest before the stress rises";
  }
  return loading;
}

}  // namespace

bool is_pulled(const Reduction& reduction) {
  return sense_of(reduction.stress_Pa) < 0.0;
}

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
    return {.no_loading = "there are no histories"};
  }
  const double sense = sense_of(reduction.stress_Pa);
  // What follows the first loading may go further: it is of later passes of the wave.
  const std::size_t pass = std::max<std::size_t>(first_pass(reduction, sense), 1);
  const std::span stress_Pa = std::span(reduction.stress_Pa).first(pass);
  const std::span strain = std::span(reduction.strain).first(pass);
  const std::size_t peak = index_of_largest(in_sense(stress_Pa, sense));
  LoopSummary summary;
  summary.peak_stress_Pa = stress_Pa[peak];
  summary.strain_at_peak = strain[peak];
  summary.peak_strain = strain[index_of_largest(in_sense(strain, sense))];
  const Loading loading = loading_of(reduction, sense);
  if (!loading.missing.empty()) {
    // In what sense it is loaded is not known then, nor how it should have moved.
    if (sign_is_wrong(reduction.quality)) {
      summary.no_loading =
          "stress and strain do not go together, a gauge seems to read with the "
          "other sign (gauge_sign)";
      return summary;
    }
    summary.no_loading = loading.missing;
    if (push_hidden(reduction.quality)) {
      summary.no_loading += "; the reflection hides the striker's push (window_overlap)";
    }
    return summary;
  }
  summary.loading_s = reduction.time_s[loading.end] - reduction.time_s[loading.begin];
  summary.mean_strain_rate_per_s =
      (reduction.strain[loading.end] - reduction.strain[loading.begin]) / summary.loading_s;
  return summary;
}

}  // namespace kolsky
