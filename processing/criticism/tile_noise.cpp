#include "processing/criticism/tile_noise.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "processing/criticism/statistics.hpp"

namespace kolsky {

namespace {

/// A real record's transform at whole frequencies, as far to both sides as a length of it.
class Lines {
 public:
  Lines(DampedTransform& transform, std::span<const double> record) : length_(record.size()) {
    lines_.resize(3 * length_);
    const auto once = lines_.begin();
    const auto twice = once + static_cast<std::ptrdiff_t>(length_);
    transform.forward(record, std::span(lines_).first(transform.bins()));
    for (std::size_t k = transform.bins(); k < length_; ++k) {
      lines_[k] = std::conj(lines_[length_ - k]);
    }
    std::copy(once, twice, std::copy(once, twice, twice));
  }

  [[nodiscard]] Complex at(std::ptrdiff_t frequency) const {
    return lines_[static_cast<std::size_t>(frequency + static_cast<std::ptrdiff_t>(length_))];
  }

 private:
  std::size_t length_;
  std::vector<Complex> lines_;
};

/// A product without a general one's checks for infinities.
Complex times(Complex a, Complex b) {
  return {a.real() * b.real() - a.imag() * b.imag(), a.real() * b.imag() + a.imag() * b.real()};
}

/// Second moments of a windowed record's spectrum U, for a record of independent judged bins
/// Z(k), E|Z|^2 = 2, less its mean by the weights v:
///
///     U(f) = sum_k Z(k) [w(f-k) - v(k)* w(f)] + Z(k)* [w(f+k) - v(k) w(f)]
///
/// The sums over k of products at two frequencies differ from those one bin on by their ends alone.
class SpectralMoments {
 public:
  SpectralMoments(DampedTransform& transform, std::span<const double> window,
                  std::span<const double> quiet, std::size_t judged)
      : judged_(static_cast<std::ptrdiff_t>(judged)), w_(transform, window) {
    shared_.assign(transform.bins(), 0.0);
    if (quiet.empty()) {
      return;
    }
    // sum over the judged k of both signs of v(k) w(f-k): a product in time.
    std::vector<Complex> v(transform.bins());
    transform.forward(quiet, v);
    for (std::size_t k = 0; k < v.size(); ++k) {
      v[k] = k >= 1 && k <= judged ? v[k] : 0.0;
      quiet_ += std::norm(v[k]);
    }
    std::vector<double> part(window.size());
    transform.inverse(v, part);
    for (std::size_t t = 0; t < part.size(); ++t) {
      part[t] *= window[t] * static_cast<double>(window.size());
    }
    transform.forward(part, shared_);
  }

  /// E |U(f)|^2 over a range of bins.
  [[nodiscard]] Eigen::VectorXd energies(const BinRange& range) const {
    Eigen::VectorXd out(static_cast<Eigen::Index>(range.end - range.first));
    Complex sum = 0.0;
    for (Eigen::Index i = 0; i < out.size(); ++i) {
      const std::ptrdiff_t f = static_cast<std::ptrdiff_t>(range.first) + i;
      sum = i > 0 ? next_alike(sum, f, f) : alike(f, f);
      out[i] = 2.0 * less_mean(sum, f, f).real();
    }
    return out;
  }

  /// E U(f) U(g)* and E U(f) U(g) over a range of bins.
  struct Covariance {
    Eigen::MatrixXcd proper;
    Eigen::MatrixXcd other;
  };
  [[nodiscard]] Covariance over(const BinRange& range) const {
    const auto first = static_cast<std::ptrdiff_t>(range.first);
    const auto bins = static_cast<Eigen::Index>(range.end - range.first);
    Covariance out{Eigen::MatrixXcd(bins, bins), Eigen::MatrixXcd(bins, bins)};
    Eigen::MatrixXcd crossed(bins, bins);
    for (Eigen::Index g = 0; g < bins; ++g) {
      for (Eigen::Index f = 0; f < bins; ++f) {
        if (g >= f) {
          out.proper(f, g) = f > 0 ? next_alike(out.proper(f - 1, g - 1), first + f, first + g)
                                   : alike(first + f, first + g);
        }
      }
      for (Eigen::Index f = bins; f-- > 0;) {
        crossed(f, g) = g > 0 && f + 1 < bins
                            ? before_crossed(crossed(f + 1, g - 1), first + f, first + g)
                            : crossing(first + f, first + g);
      }
    }
    for (Eigen::Index g = 0; g < bins; ++g) {
      for (Eigen::Index f = 0; f <= g; ++f) {
        const std::ptrdiff_t at_f = first + f;
        const std::ptrdiff_t at_g = first + g;
        out.proper(f, g) = 2.0 * less_mean(out.proper(f, g), at_f, at_g);
        out.proper(g, f) = std::conj(out.proper(f, g));
        const Complex mean = times(shared_at(at_f), w_.at(at_g)) +
                             times(w_.at(at_f), shared_at(at_g)) -
                             2.0 * quiet_ * times(w_.at(at_f), w_.at(at_g));
        out.other(f, g) = out.other(g, f) = 2.0 * (crossed(f, g) + crossed(g, f) - mean);
      }
    }
    return out;
  }

 private:
  [[nodiscard]] Complex shared_at(std::ptrdiff_t f) const {
    return shared_[static_cast<std::size_t>(f)];
  }
  [[nodiscard]] Complex less_mean(Complex sum, std::ptrdiff_t f, std::ptrdiff_t g) const {
    const Complex w_f = w_.at(f);
    const Complex w_g = std::conj(w_.at(g));
    return sum - times(shared_at(f), w_g) - times(w_f, std::conj(shared_at(g))) +
           2.0 * quiet_ * times(w_f, w_g);
  }
  // sum of w(f-k) w(g-k)* + w(f+k) w(g+k)*
  [[nodiscard]] Complex alike(std::ptrdiff_t f, std::ptrdiff_t g) const {
    Complex sum = 0.0;
    for (std::ptrdiff_t k = 1; k <= judged_; ++k) {
      sum += times(w_.at(f - k), std::conj(w_.at(g - k)));
      sum += times(w_.at(f + k), std::conj(w_.at(g + k)));
    }
    return sum;
  }
  [[nodiscard]] Complex next_alike(Complex before, std::ptrdiff_t f, std::ptrdiff_t g) const {
    const auto product = [&](std::ptrdiff_t off) {
      return times(w_.at(f + off), std::conj(w_.at(g + off)));
    };
    return before + product(-1) - product(-1 - judged_) - product(0) + product(judged_);
  }
  // sum of w(f-k) w(g+k)
  [[nodiscard]] Complex crossing(std::ptrdiff_t f, std::ptrdiff_t g) const {
    Complex sum = 0.0;
    for (std::ptrdiff_t k = 1; k <= judged_; ++k) {
      sum += times(w_.at(f - k), w_.at(g + k));
    }
    return sum;
  }
  /// Of (f, g), from that of (f + 1, g - 1).
  [[nodiscard]] Complex before_crossed(Complex after, std::ptrdiff_t f, std::ptrdiff_t g) const {
    return after - times(w_.at(f), w_.at(g)) + times(w_.at(f - judged_), w_.at(g + judged_));
  }

  std::ptrdiff_t judged_;
  Lines w_;
  std::vector<Complex> shared_;
  double quiet_ = 0.0;
};

/// Operations that a tile's exact moments may cost.
constexpr std::size_t kMostOperations = 1'000'000;

/// By root: of each bin's share in the energy.
TileNoise exact(SpectralMoments::Covariance moments, const Eigen::VectorXd& root) {
  const Eigen::Index bins = root.size();
  for (Eigen::MatrixXcd* part : {&moments.proper, &moments.other}) {
    *part = (root.asDiagonal() * *part * root.asDiagonal()).eval();
  }
  // Of real and imaginary parts.
  Eigen::MatrixXd covariance(2 * bins, 2 * bins);
  covariance.topLeftCorner(bins, bins) = 0.5 * (moments.proper + moments.other).real();
  covariance.bottomRightCorner(bins, bins) = 0.5 * (moments.proper - moments.other).real();
  covariance.topRightCorner(bins, bins) = 0.5 * (moments.other - moments.proper).imag();
  covariance.bottomLeftCorner(bins, bins) = covariance.topRightCorner(bins, bins).transpose();
  return {covariance.trace(), covariance.squaredNorm(),
          (covariance * covariance).cwiseProduct(covariance).sum()};
}

/// As if the window's spectrum were narrow against the judged band.
TileNoise nearly(double mean, const Lines& squared, const BinRange& range,
                 const Eigen::VectorXd& root) {
  TileNoise noise{mean, 0.0, 0.0};
  const auto first = static_cast<std::ptrdiff_t>(range.first);
  const auto bins = static_cast<std::ptrdiff_t>(range.end - range.first);
  for (std::ptrdiff_t f = 0; f < bins; ++f) {
    for (std::ptrdiff_t g = 0; g < bins; ++g) {
      const double share = root[f] * root[f] * root[g] * root[g];
      noise.second +=
          2.0 * share * (std::norm(squared.at(f - g)) + std::norm(squared.at(2 * first + f + g)));
    }
  }
  noise.third = noise.second * noise.second / noise.mean;
  return noise;
}

}  // namespace

double TileNoise::log_tail(double energy) const {
  if (second <= 0.0 || third <= 0.0) {
    return 0.0;
  }
  const double free = second * second * second / (third * third);
  return log_chi2_tail(free + (energy - mean) * std::sqrt(free / second), free);
}

TileNoise& TileNoise::operator+=(const TileNoise& other) {
  mean += other.mean;
  second += other.second;
  third += other.third;
  return *this;
}

std::vector<TileNoise> tile_noise(DampedTransform& transform, std::span<const double> window,
                                  std::span<const double> quiet, std::size_t judged,
                                  std::span<const BinRange> ranges) {
  const SpectralMoments moments(transform, window, quiet, judged);
  std::vector<double> square(window.begin(), window.end());
  for (double& value : square) {
    value *= value;
  }
  const Lines squared(transform, square);
  const auto n = static_cast<double>(window.size());
  std::vector<TileNoise> list;
  for (const BinRange& range : ranges) {
    const std::size_t bins = range.end - range.first;
    Eigen::VectorXd root(static_cast<Eigen::Index>(bins));
    for (std::size_t f = range.first; f < range.end; ++f) {
      const bool half = f == 0 || 2 * f == window.size();
      root[static_cast<Eigen::Index>(f - range.first)] = (half ? std::sqrt(0.5) : 1.0) / n;
    }
    if (4 * bins * bins * 2 * judged <= kMostOperations) {
      list.push_back(exact(moments.over(range), root));
      continue;
    }
    const double mean = root.array().square().matrix().dot(moments.energies(range));
    // Beyond the judged band the window smears little.
    const BinRange judged_part{range.first, std::min(range.end, judged + 1)};
    list.push_back(nearly(mean, squared, judged_part, root * std::sqrt(n)));
  }
  return list;
}

}  // namespace kolsky
