#include "processing/criticism/fitting/record_parts.hpp"

#include <cmath>
#include <numbers>

#include "processing/algebra/algebra.hpp"

namespace kolsky {

namespace {

/// Orthonormal columns: what the real and the imaginary part of each bin of a whitened spectrum is
/// in time. Squares stay what they are.
Eigen::MatrixXd waves_in_time(Eigen::Index bins) {
  const Eigen::Index instants = 2 * bins + 1;
  const double unit = std::sqrt(2.0 / static_cast<double>(instants));
  Eigen::MatrixXd waves(instants, 2 * bins);
  for (Eigen::Index k = 0; k < bins; ++k) {
    for (Eigen::Index n = 0; n < instants; ++n) {
      const double turns =
          static_cast<double>(((k + 1) * n) % instants) / static_cast<double>(instants);
      waves(n, 2 * k) = unit * std::cos(2.0 * std::numbers::pi * turns);
      waves(n, 2 * k + 1) = -unit * std::sin(2.0 * std::numbers::pi * turns);
    }
  }
  return waves;
}

/// Rows of spectra, channel by channel in time.
Eigen::MatrixXd in_time(const Eigen::MatrixXd& spectra, Eigen::Index channels) {
  const Eigen::Index bins = spectra.rows() / (2 * channels);
  const Eigen::MatrixXd waves = waves_in_time(bins);
  Eigen::MatrixXd times(channels * waves.rows(), spectra.cols());
  Eigen::MatrixXd own(2 * bins, spectra.cols());
  for (Eigen::Index c = 0; c < channels; ++c) {
    for (Eigen::Index k = 0; k < bins; ++k) {
      own.middleRows(2 * k, 2) = spectra.middleRows(2 * (k * channels + c), 2);
    }
    times.middleRows(c * waves.rows(), waves.rows()).noalias() = waves * own;
  }
  return times;
}

/// The rows of one part in all channels.
std::vector<Eigen::Index> rows_of(std::size_t part, Eigen::Index instants, Eigen::Index channels) {
  constexpr Eigen::Index kStretchesPerPart = 8;
  constexpr auto kParts = static_cast<Eigen::Index>(kRecordParts);
  std::vector<Eigen::Index> rows;
  for (Eigen::Index c = 0; c < channels; ++c) {
    for (Eigen::Index n = 0; n < instants; ++n) {
      const Eigen::Index stretch = n * kStretchesPerPart * kParts / instants;
      if (stretch % kParts == static_cast<Eigen::Index>(part)) {
        rows.push_back(c * instants + n);
      }
    }
  }
  return rows;
}

}  // namespace

std::vector<double> held_out_parts(const ModelFit& fit, std::size_t channels) {
  const auto count = static_cast<Eigen::Index>(channels);
  const Eigen::MatrixXd residual = in_time(fit.residual, count);
  const Eigen::MatrixXd jacobian = in_time(fit.jacobian, count);
  const Eigen::Index instants = residual.rows() / count;
  std::vector<double> squares;
  for (std::size_t part = 0; part < kRecordParts; ++part) {
    const std::vector<Eigen::Index> rows = rows_of(part, instants, count);
    Eigen::VectorXd own = residual(rows, 0);
    if (!fit.theta.empty()) {
      const Eigen::MatrixXd columns = jacobian(rows, Eigen::all);
      const Eigen::MatrixXd others = fit.information - columns.transpose() * columns;
      own += columns * least_norm_solution(others, columns.transpose() * own);
    }
    squares.push_back(own.squaredNorm());
  }
  return squares;
}

}  // namespace kolsky
