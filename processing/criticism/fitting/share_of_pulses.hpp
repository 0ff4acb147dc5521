#pragma once

#include <Eigen/Core>

namespace kolsky {

/// What one fit leaves of the records, whitened, and what of their pulses alone
/// (`WhiteResiduals::whiten_pulses`).
struct LeftByFit {
  const Eigen::VectorXd& records;
  const Eigen::VectorXd& pulses;  ///< empty: not known, and then they are all
};

/// Of what two fits make differently of the records, in squares, that which they make of the
/// pulses. The source follows the reference gauge's noise through the whole record, and each fit
/// carries that noise to the other gauges in its own way: their sums of squares differ by chance,
/// with a variance of four times the difference, even where the pulses are the same to both, as to
/// an end that answers after the record's.
[[nodiscard]] double share_of_pulses(const LeftByFit& one, const LeftByFit& other);

}  // namespace kolsky
