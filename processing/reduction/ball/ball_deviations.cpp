#include "processing/reduction/ball/ball_deviations.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "processing/reduction/ball/contact_numbers.hpp"

namespace kolsky {

namespace {

constexpr std::size_t kMostDraws = 200;

}  // namespace

ForceDeviations drawn_deviations(std::span<const double> force_N, const QuietForce& quiet,
                                 double threshold, const SampleRange& contact) {
  const std::size_t length = contact.end - contact.begin;
  const std::size_t room = quiet.force_N.size() - quiet.baseline_samples - length;
  const std::size_t step = std::max<std::size_t>(1, room / kMostDraws);
  const std::size_t peak = index_of_largest(force_N);
  const double peak_N = force_N[peak];
  const Stay truth = stay_above(force_N, peak, threshold * peak_N);
  std::vector<double> force(force_N.begin(), force_N.end());
  ForceDeviations sums;
  std::size_t draws = 0;
  for (std::size_t offset = 0; offset <= room; offset += step, ++draws) {
    const double level = mean_of(quiet.force_N.subspan(offset, quiet.baseline_samples));
    const auto noise = quiet.force_N.subspan(offset + quiet.baseline_samples, length);
    double impulse_N_s = 0.0;
    for (std::size_t n = 0; n < length; ++n) {
      force[contact.begin + n] = force_N[contact.begin + n] + noise[n] - level;
      impulse_N_s += (noise[n] - level) * quiet.period_s;
    }
    const std::size_t there = index_of_largest(force);
    const Stay stay = stay_above(force, there, threshold * force[there]);
    sums.peak_sd += std::pow(force[there] - peak_N, 2);
    sums.impulse_sd += impulse_N_s * impulse_N_s;
    sums.contact_sd +=
        std::pow((stay.end - stay.begin - truth.end + truth.begin) * quiet.period_s, 2);
  }
  for (double* sum : {&sums.peak_sd, &sums.impulse_sd, &sums.contact_sd}) {
    *sum = std::sqrt(*sum / static_cast<double>(draws));
  }
  return sums;
}

}  // namespace kolsky
