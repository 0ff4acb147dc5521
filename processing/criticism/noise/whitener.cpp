#include "processing/criticism/noise/whitener.hpp"

#include <algorithm>
#include <cmath>

#include "processing/criticism/noise/small_factor.hpp"

namespace kolsky {

namespace {

/// Covariances of residuals and of gauges' noise at one bin.
class AtBin {
 public:
  AtBin(const GaugeNoise& noise, const CarriedBin& carried, std::size_t bin, std::size_t reference,
        const std::vector<std::size_t>& others)
      : noise_(noise),
        carried_(carried),
        bin_(bin),
        reference_(reference),
        others_(others),
        rows_(static_cast<Eigen::Index>(others.size())),
        long_reference_(carried.ratio.size() > rows_ + 1),
        shared_(noise.shared_with(reference)),
        mean_(long_reference_ ? carried.ratio[rows_] / carried.ratio[rows_ + 1] : Complex(1.0)),
        of_reference_(noise.covariance(bin, reference, reference)),
        scale_(noise.scale(reference, bin)) {}

  /// Of a gauge's noise with a residual.
  [[nodiscard]] Complex cross(std::size_t gauge, Eigen::Index i) const {
    const Eigen::Index all = carried_.ratio.size() - 1;
    return shared_ ? std::conj(mean_) * rest(gauge, other(i)) +
                         part(gauge) * scale_ *
                             (part(other(i)) * carried_.power(all, rows_) - carried_.power(all, i))
                   : std::conj(mean_) * noise(gauge, other(i)) -
                         std::conj(carried_.ratio[i]) * noise(gauge, reference_);
  }

  /// Of two residuals: G P G^H, but of the reference's own noise what is carried.
  [[nodiscard]] Complex between(Eigen::Index i, Eigen::Index j) const {
    const Complex carried_on = scale_ * carried_.power(i, j);
    if (!shared_) {
      return std::norm(mean_) * noise(other(i), other(j)) + carried_on;
    }
    const double a = part(other(i));
    const double b = part(other(j));
    return std::norm(mean_) * rest(other(i), other(j)) + carried_on +
           scale_ * (a * b * carried_.power(rows_, rows_) - a * carried_.power(rows_, j) -
                     b * carried_.power(i, rows_));
  }

  /// Of a residual with itself, what leaks included.
  [[nodiscard]] double variance(Eigen::Index i) const {
    return between(i, i).real() + leaked_of_other(i);
  }

  /// Where gauges contradict each other.
  [[nodiscard]] double least_variance(Eigen::Index i) const {
    constexpr double kLeast = 1e-3;
    return kLeast * noise(other(i), other(i));
  }

  /// Share of a residual's variance that is leaked beyond what a point would leak of the
  /// reference's noise, of which as much leaks as ever: beside what a mean leaves it is more.
  [[nodiscard]] double leaked_share(Eigen::Index i) const {
    if (!long_reference_) {
      return 0.0;
    }
    const double carried_on = scale_ * carried_.power(i, i).real();
    const double of_own = std::max(0.0, carried_on - std::norm(carried_.ratio[i]) * of_reference_);
    const double beside_a_point = of_own / (noise(other(i), other(i)) + carried_on);
    return std::max(0.0, (leaked_of_other(i) + of_own) / variance(i) - beside_a_point);
  }

 private:
  [[nodiscard]] std::size_t other(Eigen::Index i) const {
    return others_[static_cast<std::size_t>(i)];
  }
  [[nodiscard]] double noise(std::size_t a, std::size_t b) const {
    return noise_.covariance(bin_, a, b);
  }
  /// What a gauge has of the reference's noise comes through the window with what waves carry of
  /// it: the slower it is, the more the two cancel, and no more than that may be left.
  [[nodiscard]] double part(std::size_t gauge) const {
    return noise(gauge, reference_) / of_reference_;
  }
  [[nodiscard]] double rest(std::size_t a, std::size_t b) const {
    return shared_ ? noise(a, b) - part(a) * part(b) * of_reference_ : noise(a, b);
  }
  /// Where the reference is blind, what the window's ends leak of slow noise stays.
  [[nodiscard]] double leaked_of_other(Eigen::Index i) const {
    if (!long_reference_) {
      return 0.0;
    }
    const double kept =
        carried_.power(rows_, rows_).real() / carried_.power(rows_ + 1, rows_ + 1).real();
    return rest(other(i), other(i)) * (kept - std::norm(mean_));
  }

  const GaugeNoise& noise_;
  const CarriedBin& carried_;
  std::size_t bin_;
  std::size_t reference_;
  const std::vector<std::size_t>& others_;
  Eigen::Index rows_;
  bool long_reference_;  ///< the others' residuals take its mean
  bool shared_;
  /// Of what a window of the same length keeps of everything, so that a length of next to nothing
  /// is one of nothing.
  Complex mean_;
  double of_reference_;
  double scale_;
};

}  // namespace

Whitener::Whitener(const GaugeNoise& noise, std::size_t gauges, std::size_t reference)
    : noise_(noise), gauges_(gauges), reference_(reference) {
  for (std::size_t j = 0; j < gauges; ++j) {
    if (j != reference) {
      others_.push_back(j);
    }
  }
}

void Whitener::know(std::span<const CarriedBin> carried) {
  factor_.resize(carried.size());
  cross_.resize(carried.size());
  leaked_ = 0.0;
  for (std::size_t k = 0; k < carried.size(); ++k) {
    leaked_ += know_bin(carried[k], k);
  }
}

/// @return shares of what is foretold there that is leaked, summed over the other gauges
double Whitener::know_bin(const CarriedBin& carried, std::size_t bin) {
  const AtBin at(noise_, carried, bin, reference_, others_);
  const auto rows = static_cast<Eigen::Index>(others_.size());
  const auto gauges = static_cast<Eigen::Index>(gauges_);
  Eigen::MatrixXcd& cross = cross_[bin];
  cross.resize(gauges, rows);
  double leaked = 0.0;
  for (Eigen::Index i = 0; i < rows; ++i) {
    for (Eigen::Index j = 0; j < gauges; ++j) {
      cross(j, i) = at.cross(static_cast<std::size_t>(j), i);
    }
    leaked += at.leaked_share(i);
  }
  Eigen::MatrixXcd& factor = factor_[bin];
  factor.resize(rows, rows);
  for (Eigen::Index i = 0; i < rows; ++i) {
    for (Eigen::Index j = 0; j < i; ++j) {
      factor(i, j) = 0.5 * at.between(i, j);
    }
    factor(i, i) = 0.5 * at.variance(i);
  }
  if (!invert_factor(factor)) {
    // What gauges but the reference share is known as if it were stationary: among long echoes it
    // can contradict.
    factor.setZero();
    for (Eigen::Index i = 0; i < rows; ++i) {
      factor(i, i) = 1.0 / std::sqrt(0.5 * std::max(at.variance(i), at.least_variance(i)));
    }
  }
  return leaked;
}

}  // namespace kolsky
