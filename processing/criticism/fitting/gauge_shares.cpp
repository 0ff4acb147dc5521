#include "processing/criticism/fitting/gauge_shares.hpp"

namespace kolsky {

void GaugeShares::take(const Whitener& whitener, std::size_t bins) {
  spread_.resize(bins);
  for (std::size_t k = 0; k < bins; ++k) {
    // P G^H (L L^H)^-1 L of white: what each gauge's noise would have to be.
    spread_[k].noalias() = 0.5 * whitener.cross(k).lazyProduct(whitener.factor(k).adjoint());
  }
}

Complex GaugeShares::at(std::size_t gauge, std::size_t bin, std::span<const double> white) const {
  const Eigen::MatrixXcd& spread = spread_[bin];
  const auto others = static_cast<std::size_t>(spread.cols());
  Complex deviation = 0.0;
  for (std::size_t i = 0; i < others; ++i) {
    const std::size_t at = 2 * (bin * others + i);
    deviation += spread(static_cast<Eigen::Index>(gauge), static_cast<Eigen::Index>(i)) *
                 Complex(white[at], white[at + 1]);
  }
  return deviation;
}

}  // namespace kolsky
