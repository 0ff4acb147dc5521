#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <span>
#include <vector>

#include "processing/criticism/noise/gauge_noise.hpp"
#include "processing/criticism/noise/whitener.hpp"

namespace kolsky {

/// What the bins of a shot's whitened residuals have in common. Noise that is slow beside the
/// judged window differs between its ends, and to the transform that is a jump, which is in all
/// bins at once: of unit variance bin by bin, residuals are together up to twenty times as strong
/// in that one direction, in which there lies, too, whatever has not ended with the record (a beam
/// that still bends, a bar that creeps, a drift). With z_k the residuals at a bin and d each
/// gauge's jump in its deviations, all real,
///     z_k = B_k^(1/2) w_k + u_k d,      E w_k w_k^H = 2,      B_k = 1 - u_k C u_k^H / 2,
/// C how far gauges share their noise: residuals of covariance B + u C u^T, whose inverse root
/// makes them independent. Nothing is changed where noise is white.
class WindowJumps {
 public:
  explicit WindowJumps(std::size_t reference) : reference_(reference) {}

  /// @param carried  as `Whitener::know` had it
  void know(const GaugeNoise& noise, const Whitener& whitener, std::span<const CarriedBin> carried);

  /// Makes one shot's residuals independent, which are of unit variance bin by bin.
  void take_out(std::span<double> white) const;
  /// The other way round.
  void put_in(std::span<double> white) const;

  /// How many times as much of these jumps as is known residuals show: quiet parts are too short to
  /// tell how slow noise is. Jumps that go with the shots' sizes are none.
  /// @param white  all shots' independent residuals, shot by shot
  /// @param sizes  of the shots' sources
  /// @param most   times
  /// @return 1 where nothing is known of jumps, or there is one shot
  [[nodiscard]] double times_seen(std::span<const double> white, const Eigen::VectorXd& sizes,
                                  double most) const;

 private:
  void put_directions(const GaugeNoise& noise, const Whitener& whitener,
                      std::span<const CarriedBin> carried);
  void part_bins();
  void put_roots();
  void change(std::span<double> white, double (*by)(double square)) const;
  [[nodiscard]] Eigen::Index others() const { return roots_.front().rows(); }

  std::size_t reference_;
  Eigen::MatrixXcd directions_;  ///< B^(-1/2) u, by bin and other gauge: a column for each gauge
  std::vector<Eigen::MatrixXcd> roots_;  ///< inverse Cholesky factor of B, by bin
  Eigen::MatrixXd turn_;                 ///< to directions of their own, of unit length
  Eigen::VectorXd squares_;              ///< of what jumps add there to unit variance
};

}  // namespace kolsky
