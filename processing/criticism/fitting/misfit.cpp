#include "processing/criticism/fitting/misfit.hpp"

#include <algorithm>
#include <cmath>

#include "processing/criticism/fitting/statistics.hpp"

namespace kolsky {

namespace {

/// How much a spectrum's power is by itself, and how much of it follows the shots' sources.
struct Followed {
  double all = 0.0;
  double followed = 0.0;
};

/// @param of_shot  the spectrum in a shot, at a bin
template <typename OfShot>
void add_followed(const std::vector<std::vector<Complex>>& sources, std::size_t bin,
                  const OfShot& of_shot, Followed& sum) {
  double power = 0.0;
  Complex followed = 0.0;
  for (std::size_t n = 0; n < sources.size(); ++n) {
    const Complex own = of_shot(n);
    power += std::norm(sources[n][bin]);
    followed += own * std::conj(sources[n][bin]);
    sum.all += std::norm(own);
  }
  sum.followed += std::norm(followed) / power;
}

/// Chance (ln) that noise comes back so much, bin by bin: whatever noise each of them has.
double log_p_by_bin(const std::vector<Followed>& bins, double freedom, double rest_freedom) {
  double sum = 0.0;
  for (const Followed& bin : bins) {
    const double rest = (bin.all - bin.followed) / rest_freedom;
    sum -= 2.0 * log_f_tail(bin.followed / freedom / rest, freedom, rest_freedom);
  }
  return log_chi2_tail(sum, 2.0 * static_cast<double>(bins.size()));
}

/// Whether what does not come back is not alike at all frequencies, as lines and lumps are that the
/// quiet is too short to show: by the variance of its powers over what chance makes of it.
bool is_uneven(const std::vector<Followed>& bins, double rest_freedom) {
  constexpr double kDeviations = 6.0;
  const auto count = static_cast<double>(bins.size());
  double mean = 0.0;
  for (const Followed& bin : bins) {
    mean += (bin.all - bin.followed) / count;
  }
  double squares = 0.0;
  for (const Followed& bin : bins) {
    squares += std::pow((bin.all - bin.followed) / mean - 1.0, 2) * rest_freedom / 2.0;
  }
  // Of a chi-square over its mean q, (q - 1)^2 n/2 is 1 on average and 3 + 12/n squared.
  const double variance = count * (2.0 + 12.0 / rest_freedom);
  return squares > count + kDeviations * std::sqrt(variance);
}

/// Shares of the records' energy: of what shots leave, how much is noise that comes back in one of
/// N shots, and how much more does.
void set_shares(WhiteResiduals& residuals, const Eigen::VectorXd& white,
                const std::vector<std::vector<Complex>>& sources, Misfit& misfit) {
  const std::size_t shots = residuals.campaign().shots.size();
  std::vector<std::vector<std::vector<Complex>>> deviations;
  for (std::size_t n = 0; n < shots; ++n) {
    deviations.push_back(residuals.deviation_bins(n, white));
  }
  Followed energy;
  for (std::size_t k = 0; k < residuals.band().bins_judged; ++k) {
    for (std::size_t j = 0; j < residuals.campaign().gauges(); ++j) {
      add_followed(
          sources, k, [&](std::size_t n) { return deviations[n][j][k]; }, energy);
    }
  }
  const double of_records = residuals.energy_of_records();
  const double quiet = residuals.energy_of_noise();
  const auto count = static_cast<double>(shots);
  const double noise = shots > 1 ? (energy.all - energy.followed) * count / (count - 1.0) : quiet;
  misfit.noise_floor_share = noise / of_records;
  misfit.scatter_share = std::max(0.0, noise - quiet) / of_records;
  misfit.repeatable_share = std::max(0.0, energy.followed - noise / count) / of_records;
}

}  // namespace

Misfit misfit_of(WhiteResiduals& residuals, const Eigen::VectorXd& white, double degrees_of_freedom,
                 std::size_t worker) {
  Misfit misfit;
  misfit.degrees_of_freedom = degrees_of_freedom;
  misfit.judged_to_Hz = residuals.band().limit_Hz;
  const double chi2 = white.squaredNorm();
  misfit.chi2_reduced = chi2 / degrees_of_freedom;
  const std::size_t shots = residuals.campaign().shots.size();
  const std::size_t others = residuals.others().size();
  const std::size_t bins = residuals.band().bins_judged;
  std::vector<std::vector<Complex>> sources;
  for (std::size_t n = 0; n < shots; ++n) {
    sources.push_back(residuals.source_spectrum(n, white, worker));
  }
  set_shares(residuals, white, sources, misfit);
  if (shots < 2) {
    misfit.noise_scale = misfit.chi2_reduced;
    misfit.repeats = std::max(0.0, chi2 - degrees_of_freedom);
    return misfit;
  }
  std::vector<Followed> by_bin(bins);
  for (std::size_t k = 0; k < bins; ++k) {
    for (std::size_t i = 0; i < others; ++i) {
      const auto of_shot = [&](std::size_t n) {
        const auto at = static_cast<Eigen::Index>(n * residuals.per_shot() + residuals.index(k, i));
        return Complex(white[at], white[at + 1]);
      };
      add_followed(sources, k, of_shot, by_bin[k]);
    }
  }
  const double repeated_freedom = 2.0 * static_cast<double>(bins * others);
  const double rest_freedom = std::max(1.0, degrees_of_freedom - repeated_freedom);
  double repeated = 0.0;
  for (const Followed& bin : by_bin) {
    repeated += bin.followed;
  }
  misfit.noise_scale = (chi2 - repeated) / rest_freedom;
  misfit.repeats = std::max(0.0, repeated - repeated_freedom * misfit.noise_scale);
  misfit.repeatable_log_p =
      log_f_tail(repeated / repeated_freedom / misfit.noise_scale, repeated_freedom, rest_freedom);
  const double of_bin = 2.0 * static_cast<double>(others);
  const double rest_of_bin = of_bin * static_cast<double>(shots - 1);
  if (is_uneven(by_bin, rest_of_bin)) {
    misfit.repeatable_log_p =
        std::max(misfit.repeatable_log_p, log_p_by_bin(by_bin, of_bin, rest_of_bin));
  }
  return misfit;
}

double noise_of(const Misfit& misfit, std::size_t shots) {
  return shots > 1 ? misfit.noise_scale : std::max(1.0, misfit.noise_scale);
}

}  // namespace kolsky
