#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstddef>
#include <string>

#include "processing/criticism/fitting/drawn_rounding.hpp"
#include "processing/criticism/fitting/study.hpp"

namespace kolsky {

/// How many times ln of a chance is what it would be if it were one: those of records that lack
/// nothing spread as an exponential variable of this mean.
class Exaggerated {
 public:
  void add(double log_p) {
    sum_ -= log_p;
    most_ = std::max(most_, -log_p);
    ++count_;
    most_of_ones_ += 1.0 / static_cast<double>(count_);
  }
  /// By their mean or by the largest, whatever is more.
  [[nodiscard]] double times() const {
    return count_ == 0 ? 1.0
                       : std::max({1.0, sum_ / static_cast<double>(count_), most_ / most_of_ones_});
  }

 private:
  double sum_ = 0.0;
  double most_ = 0.0;
  double most_of_ones_ = 0.0;  ///< the largest of so many of mean 1, on average
  std::size_t count_ = 0;
};

/// Whitened residuals where rounding and white noise are all that the records hold beside the
/// model, together as strong as what the fit left.
/// @param studied  as frozen
/// @return a column by draw; none where no converter is coarse
[[nodiscard]] Eigen::MatrixXd drawn_rounding_and_noise(Study& study, const Studied& studied,
                                                       StepsLie lie);

/// By how much less chi2 is of such residuals for an effect's numbers, clear of the model's others.
/// @param drawn  a column by draw
[[nodiscard]] Eigen::VectorXd gains_by_chance(const Studied& studied, const std::string& id,
                                              const Eigen::MatrixXd& drawn);

}  // namespace kolsky
