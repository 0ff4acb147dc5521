#include "processing/criticism/fitting/misfit.hpp"

#include <algorithm>
#include <cmath>

#include "processing/criticism/fitting/statistics.hpp"

namespace kolsky {

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
  const double energy = residuals.signal_energy();
  misfit.noise_floor_share = degrees_of_freedom / energy;
  if (shots < 2) {
    misfit.noise_scale = misfit.chi2_reduced;
    misfit.repeatable_share = std::max(0.0, chi2 - degrees_of_freedom) / energy;
    return misfit;
  }
  std::vector<std::vector<Complex>> sources;
  for (std::size_t n = 0; n < shots; ++n) {
    sources.push_back(residuals.source_spectrum(n, white, worker));
  }
  const std::size_t per_shot = residuals.per_shot();
  double repeated = 0.0;
  for (std::size_t k = 0; k < bins; ++k) {
    double power = 0.0;
    for (std::size_t n = 0; n < shots; ++n) {
      power += std::norm(sources[n][k]);
    }
    for (std::size_t i = 0; i < others; ++i) {
      Complex sum = 0.0;
      for (std::size_t n = 0; n < shots; ++n) {
        const auto at = static_cast<Eigen::Index>(n * per_shot + residuals.index(k, i));
        sum += Complex(white[at], white[at + 1]) * std::conj(sources[n][k]);
      }
      repeated += std::norm(sum) / power;
    }
  }
  const double repeated_freedom = 2.0 * static_cast<double>(bins * others);
  const double rest_freedom = std::max(1.0, degrees_of_freedom - repeated_freedom);
  misfit.noise_scale = (chi2 - repeated) / rest_freedom;
  misfit.scatter_share = std::max(0.0, misfit.noise_scale - 1.0) * misfit.noise_floor_share;
  misfit.noise_floor_share *= misfit.noise_scale;
  misfit.repeatable_share =
      std::max(0.0, repeated - repeated_freedom * misfit.noise_scale) / energy;
  misfit.repeatable_log_p =
      log_f_tail(repeated / repeated_freedom / misfit.noise_scale, repeated_freedom, rest_freedom);
  return misfit;
}

double noise_of(const Misfit& misfit, std::size_t shots) {
  return shots > 1 ? misfit.noise_scale : std::max(1.0, misfit.noise_scale);
}

}  // namespace kolsky
