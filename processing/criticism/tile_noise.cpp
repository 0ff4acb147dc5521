#include "processing/criticism/tile_noise.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <optional>

#include "processing/base/wide.hpp"
#include "processing/criticism/statistics.hpp"
#include "processing/identification/wide_products.hpp"

namespace kolsky {

namespace {

/// A product without a general one's checks for infinities.
Complex times(Complex a, Complex b) {
  return {a.real() * b.real() - a.imag() * b.imag(), a.real() * b.imag() + a.imag() * b.real()};
}

using Four = double __attribute__((vector_size(32), aligned(8), may_alias));

/// Sum of conj(a) b. Four terms go together, whatever the machine: on every one to the same bits.
KOLSKY_WIDE Complex product(const double* a_re, const double* a_im, const double* b_re,
                            const double* b_im, std::size_t size) {
  Four re{};
  Four im{};
  std::size_t k = 0;
  for (; k + 4 <= size; k += 4) {
    const Four a = *reinterpret_cast<const Four*>(a_re + k);
    const Four ai = *reinterpret_cast<const Four*>(a_im + k);
    const Four b = *reinterpret_cast<const Four*>(b_re + k);
    const Four bi = *reinterpret_cast<const Four*>(b_im + k);
    re += a * b + ai * bi;
    im += a * bi - ai * b;
  }
  for (; k < size; ++k) {
    re[0] += a_re[k] * b_re[k] + a_im[k] * b_im[k];
    im[0] += a_re[k] * b_im[k] - a_im[k] * b_re[k];
  }
  return {re[0] + re[1] + re[2] + re[3], im[0] + im[1] + im[2] + im[3]};
}

/// A real record's transform at whole frequencies, so far to both sides.
class Lines {
 public:
  Lines(DampedTransform& transform, std::span<const double> record, std::size_t reach)
      : reach_(static_cast<std::ptrdiff_t>(reach)), re_(2 * reach + 1), im_(2 * reach + 1) {
    std::vector<Complex> spectrum(transform.bins());
    transform.forward(record, spectrum);
    for (std::size_t k = 0; k <= reach; ++k) {
      const std::size_t bin = k % record.size();
      const bool mirrored = bin >= spectrum.size();
      const Complex line = mirrored ? std::conj(spectrum[record.size() - bin]) : spectrum[bin];
      re_[reach + k] = re_[reach - k] = line.real();
      im_[reach + k] = line.imag();
      im_[reach - k] = -line.imag();
    }
  }

  [[nodiscard]] Complex at(std::ptrdiff_t frequency) const {
    return {re_[place(frequency)], im_[place(frequency)]};
  }
  /// Sum of conj(w(f + k)) w(g + k) over so many k from 0 on.
  [[nodiscard]] Complex product_from(std::ptrdiff_t f, std::ptrdiff_t g, std::size_t size) const {
    return product(re_.data() + place(f), im_.data() + place(f), re_.data() + place(g),
                   im_.data() + place(g), size);
  }

 private:
  [[nodiscard]] std::size_t place(std::ptrdiff_t frequency) const {
    return static_cast<std::size_t>(frequency + reach_);
  }

  std::ptrdiff_t reach_;
  std::vector<double> re_;
  std::vector<double> im_;
};

/// Second moments of a windowed record's spectrum U, for a record of independent judged bins
/// Z(k), E|Z|^2 = 2, less its mean by the weights v:
///
///     U(f) = sum_k Z(k) [w(f-k) - v(k)* w(f)] + Z(k)* [w(f+k) - v(k) w(f)]
///
/// The sums over k of products at two frequencies differ from those one bin on by their ends alone.
class SpectralMoments {
 public:
  /// @param end  of the bins that are asked for
  SpectralMoments(DampedTransform& transform, std::span<const double> window,
                  const QuietMean& quiet, std::size_t judged, std::size_t end)
      : judged_(static_cast<std::ptrdiff_t>(judged)),
        w_(transform, window, judged + end),
        shared_(transform.bins(), 0.0),
        quiet_(quiet.power) {
    if (quiet.weights.empty()) {
      return;
    }
    // sum over the judged k of both signs of v(k) w(f-k): a product in time.
    std::vector<double> part(window.begin(), window.end());
    for (std::size_t t = 0; t < part.size(); ++t) {
      part[t] *= quiet.weights[t] * static_cast<double>(part.size());
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

  /// Covariance of U's real parts over a range of bins, then its imaginary parts.
  [[nodiscard]] Eigen::MatrixXd covariance(const BinRange& range) const {
    const auto first = static_cast<std::ptrdiff_t>(range.first);
    const auto bins = static_cast<Eigen::Index>(range.end - range.first);
    Eigen::MatrixXcd alikes(bins, bins);
    Eigen::MatrixXcd crossed(bins, bins);
    for (Eigen::Index g = 0; g < bins; ++g) {
      for (Eigen::Index f = 0; f <= g; ++f) {
        alikes(f, g) = f > 0 ? next_alike(alikes(f - 1, g - 1), first + f, first + g)
                             : alike(first + f, first + g);
      }
      for (Eigen::Index f = bins; f-- > 0;) {
        crossed(f, g) = g > 0 && f + 1 < bins
                            ? before_crossed(crossed(f + 1, g - 1), first + f, first + g)
                            : crossing(first + f, first + g);
      }
    }
    Eigen::MatrixXd out(2 * bins, 2 * bins);
    for (Eigen::Index g = 0; g < bins; ++g) {
      for (Eigen::Index f = 0; f <= g; ++f) {
        const Complex w_f = w_.at(first + f);
        const Complex w_g = w_.at(first + g);
        // Halves of E U(f) U(g)* and of E U(f) U(g).
        const Complex proper = less_mean(alikes(f, g), first + f, first + g);
        const Complex other = crossed(f, g) + crossed(g, f) - times(shared_at(first + f), w_g) -
                              times(w_f, shared_at(first + g)) + 2.0 * quiet_ * times(w_f, w_g);
        out(f, g) = out(g, f) = (proper + other).real();
        out(bins + f, bins + g) = out(bins + g, bins + f) = (proper - other).real();
        out(f, bins + g) = out(bins + g, f) = (other - proper).imag();
        out(g, bins + f) = out(bins + f, g) = (other + proper).imag();
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
    const auto all = static_cast<std::size_t>(2 * judged_ + 1);
    return w_.product_from(g - judged_, f - judged_, all) - times(w_.at(f), std::conj(w_.at(g)));
  }
  [[nodiscard]] Complex next_alike(Complex before, std::ptrdiff_t f, std::ptrdiff_t g) const {
    const auto product = [&](std::ptrdiff_t off) {
      return times(w_.at(f + off), std::conj(w_.at(g + off)));
    };
    return before + product(-1) - product(-1 - judged_) - product(0) + product(judged_);
  }
  // sum of w(f-k) w(g+k)
  [[nodiscard]] Complex crossing(std::ptrdiff_t f, std::ptrdiff_t g) const {
    return w_.product_from(1 - f, 1 + g, static_cast<std::size_t>(judged_));
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

/// @param root  of each bin's share in the energy
TileNoise exact(Eigen::MatrixXd covariance, const Eigen::VectorXd& root) {
  const Eigen::VectorXd twice = root.replicate(2, 1);
  covariance = (twice.asDiagonal() * covariance * twice.asDiagonal()).eval();
  Eigen::MatrixXd square = Eigen::MatrixXd::Zero(covariance.rows(), covariance.cols());
  add_square(covariance, square);
  const Eigen::MatrixXd lower = square.cwiseProduct(covariance).triangularView<Eigen::Lower>();
  return {covariance.trace(), covariance.squaredNorm(), 2.0 * lower.sum() - lower.trace()};
}

/// As if the window's spectrum were narrow against the judged band.
/// @param squared  of the window's square
TileNoise nearly(double mean, const Lines& squared, const BinRange& range,
                 const Eigen::VectorXd& root) {
  TileNoise noise{mean, 0.0, 0.0};
  const auto first = static_cast<std::ptrdiff_t>(range.first);
  const auto bins = static_cast<std::ptrdiff_t>(range.end - range.first);
  std::vector<double> apart;
  std::vector<double> together;
  for (std::ptrdiff_t k = 0; k < 2 * bins; ++k) {
    apart.push_back(std::norm(squared.at(k)));
    together.push_back(std::norm(squared.at(2 * first + k)));
  }
  const Eigen::VectorXd share = root.array().square();
  for (std::ptrdiff_t f = 0; f < bins; ++f) {
    for (std::ptrdiff_t g = 0; g < bins; ++g) {
      noise.second += 2.0 * share[f] * share[g] *
                      (apart[static_cast<std::size_t>(std::abs(f - g))] +
                       together[static_cast<std::size_t>(f + g)]);
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

QuietMean::QuietMean(DampedTransform& transform, std::span<const double> of, std::size_t judged)
    : weights(of.size()) {
  std::vector<Complex> v(transform.bins());
  transform.forward(of, v);
  for (std::size_t k = 0; k < v.size(); ++k) {
    v[k] = k >= 1 && k <= judged ? v[k] : 0.0;
    power += std::norm(v[k]);
  }
  transform.inverse(v, weights);
}

std::vector<TileNoise> tile_noise(DampedTransform& transform, std::span<const double> window,
                                  const QuietMean& quiet, std::size_t judged,
                                  std::span<const BinRange> ranges) {
  std::size_t end = 0;
  for (const BinRange& range : ranges) {
    end = std::max(end, range.end);
  }
  const SpectralMoments moments(transform, window, quiet, judged, end);
  std::optional<Lines> squared;
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
      list.push_back(exact(moments.covariance(range), root));
      continue;
    }
    if (!squared) {
      std::vector<double> square(window.begin(), window.end());
      for (double& value : square) {
        value *= value;
      }
      squared.emplace(transform, square, 2 * end);
    }
    const double mean = root.array().square().matrix().dot(moments.energies(range));
    // Beyond the judged band the window smears little.
    const BinRange judged_part{range.first, std::min(range.end, judged + 1)};
    list.push_back(nearly(mean, *squared, judged_part, root * std::sqrt(n)));
  }
  return list;
}

}  // namespace kolsky
