#pragma once

#include <Eigen/Core>
#include <cmath>
#include <span>
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
/// own, and as if all had the same. The model's numbers stay where they are, but what it adds to
/// each shot's records already is free beside the addition: the quiet parts know a hum's slopes
/// better than the rest of the record, by which it was fitted, and a drift would mend them. Where
/// much slow noise is left beside the addition, it counts for nothing: then its slopes are that
/// noise's as well. But what is left may be another gauge's drift: an addition is judged beside
/// others, too.
class SlowNoise {
 public:
  /// @param base  fitted, its noise known by its residuals; outlives this
  SlowNoise(const Studied& base, Study& study);

  /// An addition of each shot's own.
  struct Addition {
    const Candidate& candidate;
    const Direction& direction;
  };

  /// ln of the chance that slow noise gains as much by the additions together.
  [[nodiscard]] double log_chance(std::span<const Addition> additions) const;

  /// ln of the chance that noise gains as much by one addition where others are there, too. Where
  /// nothing slow stays beside all of them, it is known what noise does.
  [[nodiscard]] double log_chance_beside(const Addition& addition,
                                         std::span<const Addition> others) const;

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
  /// Of what additions leave, the noise at its best.
  struct Fitted {
    double twice_log_likelihood = -HUGE_VAL;
    Levels levels;
  };

  /// What the model itself adds, of each shot's own.
  [[nodiscard]] Columns of_model() const;
  [[nodiscard]] static Columns turned(const Form& form, Columns columns);
  void add_columns(const Addition& addition, Columns& columns) const;
  [[nodiscard]] Eigen::VectorXd column_of(const Composition& composition,
                                          const std::vector<double>& theta, std::size_t number,
                                          const Eigen::VectorXd& in_residuals) const;
  static void append(Columns& columns, std::ptrdiff_t shot, const Eigen::VectorXd& column);
  [[nodiscard]] double log_chance(const Form& form, Columns columns) const;
  /// @param beside  a part of the columns: by how much these gain over it
  [[nodiscard]] static double gain(const Form& form, const Eigen::MatrixXd& seen,
                                   const Columns& columns, const Columns& beside);
  [[nodiscard]] static Fitted fitted(const Form& form, const Eigen::MatrixXd& seen,
                                     const Columns& columns, Levels levels);
  /// @param slow  variances as in `Form`
  /// @param from  where the search for them begins
  [[nodiscard]] static Levels best_levels(const Eigen::ArrayXd& slow, const Eigen::MatrixXd& seen,
                                          Levels from);
  [[nodiscard]] static double twice_log_likelihood(const Eigen::ArrayXd& slow,
                                                   const Eigen::MatrixXd& seen,
                                                   const Levels& levels);

  const Studied& base_;
  const Campaign& campaign_;
  Eigen::Index per_shot_;  ///< residuals, of all bins
  Eigen::Index lowest_;    ///< of these, of the lowest bins
  Eigen::Index rows_;      ///< these and what the quiet parts show
  Eigen::MatrixXd seen_;   ///< of every shot a column
  Columns of_model_;
  std::vector<Form> forms_;
};

}  // namespace kolsky
