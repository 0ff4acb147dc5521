#include "processing/specimen/slow_noise_factor.hpp"

#include <cmath>

namespace kolsky {

Eigen::MatrixXd by_slow_noise(Eigen::MatrixXd response, const NoiseSpectrum::SlowPart& part,
                              double samples) {
  const double keep = std::pow(part.keep, samples);
  const double sd = std::sqrt(part.variance_of_mean(samples));
  // A cause goes on through all later groups.
  for (Eigen::Index group = response.cols() - 1; group-- > 0;) {
    response.col(group) += keep * response.col(group + 1);
  }
  response *= sd * std::sqrt(1.0 - keep * keep);
  response.col(0) /= std::sqrt(1.0 - keep * keep);
  return response;
}

}  // namespace kolsky
