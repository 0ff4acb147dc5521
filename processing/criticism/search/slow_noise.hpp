#pragma once

#include <Eigen/Core>
#include <vector>

#include "processing/criticism/search/candidates.hpp"

namespace kolsky {

/// What slow noise does to additions that every shot has of its own. What a hum or a drift adds is
/// nearly a slope over a record that is short beside its period, and slow noise slopes, too: a fit
/// that learns its noise from what differs between shots takes either for the other. But slow noise
/// turns at all times, so that much of it stays when its slopes are gone; of a hum nothing does.
///
/// The statistic is a likelihood ratio, with the addition over without, the noise at its best in
/// both: white as the high frequencies have it and slow as the low ones do, each times a level. It
/// looks at the residuals' lowest bins and at how the quiet parts turn. The covariance of slow
/// noise is that of noise which came through baseline, waves and window as records do: a window
/// makes the bins of what is slower than itself hang together, a slope's entirely. Levels are
/// found, and the statistic's distribution drawn, twice: as if every gauge had slow noise of its
/// own, and as if all had the same. The model's numbers stay where they are. Where much slow noise
/// is left beside the addition, it counts for nothing: then its slopes are that noise's as well.
class SlowNoise {
 public:
  /// @param base  fitted, its noise known by its residuals; outlives this
  SlowNoise(const Studied& base, Study& study);

  /// ln of the chance that slow noise gains as much by the addition.
  [[nodiscard]] double log_chance(const Candidate& candidate, const Direction& direction) const;

 private:
  /// White and slow noise of one shot, in coordinates in which both are diagonal.
  struct Form {
    bool own = true;  ///< every gauge has slow noise of its own
    Eigen::MatrixXd turn;
    Eigen::VectorXd slow;  ///< variances where those of white noise are 1
  };
  struct Levels {
    double white = 1.0;
    double slow = 1.0;
  };

  /// By shot: what its own strengths do to what is seen of it.
  using Columns = std::vector<Eigen::MatrixXd>;
  /// What the addition explains, and the noise without it and with it.
  struct Gain {
    double twice_log_likelihood = 0.0;
    Levels without;
    Levels with;
  };

  [[nodiscard]] Columns columns_of(const Candidate& candidate, const Direction& direction) const;
  [[nodiscard]] double log_chance(const Form& form, Columns columns) const;
  [[nodiscard]] Gain gain(const Form& form, const Eigen::MatrixXd& seen,
                          const Columns& columns) const;
  /// -2 ln of the likelihood of what is seen, the levels at their best from where they are.
  [[nodiscard]] static double at_best_levels(const Form& form, const Eigen::MatrixXd& seen,
                                             Levels& levels);

  const Studied& base_;
  const Campaign& campaign_;
  Eigen::Index per_shot_;  ///< residuals, of all bins
  Eigen::Index lowest_;    ///< of these, of the lowest bins
  Eigen::Index rows_;      ///< these and what the quiet parts show
  Eigen::MatrixXd seen_;   ///< of every shot a column
  std::vector<Form> forms_;
};

}  // namespace kolsky
