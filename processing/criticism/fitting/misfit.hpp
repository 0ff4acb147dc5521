#pragma once

#include <Eigen/Core>

#include "processing/criticism/fitting/residuals.hpp"

namespace kolsky {

/// How far a model is from the records.
struct Misfit {
  double chi2_reduced = 0.0;
  double degrees_of_freedom = 0.0;
  double repeatable_share = 0.0;   ///< of the signal's energy: misfit that comes back shot by shot
  double noise_floor_share = 0.0;  ///< of the signal's energy: what does not come back
  double scatter_share = 0.0;      ///< of that, what is more than the noise measured
  double repeats = 0.0;            ///< of chi2: what comes back and is more than noise
  /// Power of what does not repeat over the noise measured before the pulses; 1 where the noise is
  /// all there is. With one shot, of all residuals.
  double noise_scale = 1.0;
  double repeatable_log_p = 0.0;  ///< ln probability of so much repeating under noise alone
  double judged_to_Hz = 0.0;      ///< what lies above is in no number here; 0: in all there is
};

/// The scale by which residuals of so many shots are judged: one shot cannot show that the noise is
/// less than what was measured before its pulse.
[[nodiscard]] double noise_of(const Misfit& misfit, std::size_t shots);

/// What repeats: at each frequency and gauge, the part of the residuals that follows the shots'
/// sources. What a linear, unchanging error of the model leaves is all there; noise is there by its
/// share of one of N shots, and the rest measures it. Shares are of strain squared over the judged
/// window and band, all gauges and shots together, whatever noise each has: what plots show.
[[nodiscard]] Misfit misfit_of(WhiteResiduals& residuals, const Eigen::VectorXd& white,
                               double degrees_of_freedom, std::size_t worker = 0);

}  // namespace kolsky
