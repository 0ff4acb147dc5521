#pragma once

#include <span>
#include <utility>
#include <vector>

namespace kolsky {

/// ln of the probability that a chi-square variable of k degrees of freedom exceeds x; exact far
/// into the tail, where the probability itself underflows.
[[nodiscard]] double log_chi2_tail(double x, double k);

/// The same for Fisher's F with m and n degrees of freedom.
[[nodiscard]] double log_f_tail(double f, double m, double n);

/// Of which signs the strength of an effect may be.
enum class Signs { both, one };

/// ln of the probability that noise lets an effect gain so much chi2.
/// @param freedom  strengths and other numbers that the effect is free in, at least 1
[[nodiscard]] double log_gain_tail(double gain, double freedom, Signs signs);

/// Evidence on one scale whatever the number of free strengths: the square of the normal deviate
/// with this two-sided tail probability.
[[nodiscard]] double equivalent_square(double log_tail);

/// The same for a square that is measured by noise of which so many degrees of freedom are known
/// (Student's t); what is not above 0 stays.
[[nodiscard]] double square_on_noise(double square, double known);

/// ln of the chance of several tests taken together, whatever depends on what among them (Cauchy's
/// combination; Liu and Xie 2020): of one that stands out, its own chance over its weight.
/// @param weights  of sum 1
[[nodiscard]] double combined_log_p(std::span<const double> log_ps,
                                    std::span<const double> weights);

/// Share of false ones among the places that a comparison marks, at most.
inline constexpr double kFalseDiscovery = 0.005;

/// The largest of these ln p that still counts where false discovery is held at that share
/// (Benjamini and Hochberg 1995); below all of them where none does.
[[nodiscard]] double discovery_limit(std::vector<double> log_ps);

/// Marks the places whose `log_p` counts.
template <class Place>
void mark_significant(std::vector<Place>& places) {
  std::vector<double> log_ps;
  for (const Place& place : places) {
    log_ps.push_back(place.log_p);
  }
  const double limit = discovery_limit(std::move(log_ps));
  for (Place& place : places) {
    place.significant = place.log_p <= limit;
  }
}

}  // namespace kolsky
