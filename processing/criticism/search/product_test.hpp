#pragma once

#include <Eigen/Core>
#include <cstddef>

namespace kolsky {

/// What strengths by shot and gauge say of being products: complex ones, of a complex number per
/// shot (a hum's amplitude and phase) and a real one per gauge (how much of it the gauge picks up).
struct ProductTest {
  double log_p = 0.0;  ///< ln of the chance that noise comes so near to products
  /// How much more of the strengths the products explain than strengths at any one gauge, in units
  /// of what neither explains per degree of freedom: little, where only one gauge is noisy.
  double beyond_one_gauge = 0.0;
};

/// Noise here is whatever differs from place to place, whatever its power in cosine and sine: the
/// share that products explain is compared with the share that they explain of simulated noise.
/// Products whose shares are all equal are tried by themselves: they have less freedom, so that a
/// hum which is alike at all gauges stands out sooner. The better of both counts, as one of two.
/// @param strengths    cosine parts, then sine parts; in each by shot and then by gauge; under a
///                     prior of unit deviation around zero
/// @param information  inverse of their posterior covariance, that prior included
/// @return log_p = 0 with fewer than two shots or three gauges: nothing can be told
[[nodiscard]] ProductTest test_products(const Eigen::VectorXd& strengths,
                                        const Eigen::MatrixXd& information, std::size_t shots,
                                        std::size_t gauges);

/// Products of any shares.
struct NearestProducts {
  Eigen::VectorXd strengths;  ///< that they are
  double left = 0.0;          ///< square of what is left of those found, over the records' noise
};
/// Those nearest to strengths, of two gauges and more. Arguments as above.
[[nodiscard]] NearestProducts nearest_products(const Eigen::VectorXd& strengths,
                                               const Eigen::MatrixXd& information,
                                               std::size_t shots, std::size_t gauges);

}  // namespace kolsky
