#include "processing/criticism/comparing/tile_noise.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>

#include "processing/base/wide.hpp"
#include "processing/criticism/fitting/statistics.hpp"

namespace kolsky {

namespace {

/// A product without a general one's checks for infinities.
Complex times(Complex a, Complex b) {
  return {a.real() * b.real() - a.imag() * b.imag(), a.real() * b.imag() + a.imag() * b.real()};
}

using Four = double __attribute__((vector_size(32), aligned(8), may_alias));

/// Four terms of a sum of conj(a) b at a time.
struct FourTerms {
  Four re{};
  Four im{};

  [[gnu::always_inline]] void add(const double* a_re, const double* a_im, const double* b_re,
                                  const double* b_im) {
    const Four a = *reinterpret_cast<const Four*>(a_re);
    const Four ai = *reinterpret_cast<const Four*>(a_im);
    const Four b = *reinterpret_cast<const Four*>(b_re);
    const Four bi = *reinterpret_cast<const Four*>(b_im);
    re += a * b + ai * bi;
    im += a * bi - ai * b;
  }
};

/// Sum of conj(a) b, in one order whatever the machine: on every one to the same bits. Two sums
/// side by side, or each term would wait for the one before.
KOLSKY_WIDE Complex product(const double* a_re, const double* a_im, const double* b_re,
                            const double* b_im, std::size_t size) {
  FourTerms even;
  FourTerms odd;
  std::size_t k = 0;
  for (; k + 8 <= size; k += 8) {
    even.add(a_re + k, a_im + k, b_re + k, b_im + k);
    odd.add(a_re + k + 4, a_im + k + 4, b_re + k + 4, b_im + k + 4);
  }
  Four re = even.re + odd.re;
  Four im = even.im + odd.im;
  for (; k < size; ++k) {
    re[k % 4] += a_re[k] * b_re[k] + a_im[k] * b_im[k];
    im[k % 4] += a_re[k] * b_im[k] - a_im[k] * b_re[k];
  }
  return {re[0] + re[1] + re[2] + re[3], im[0] + im[1] + im[2] + im[3]};
}

/// A real record's transform at whole frequencies, so far to both sides: less than twice its
/// length.
class Lines {
 public:
  Lines(DampedTransform& transform, std::span<const double> record, std::size_t reach)
      : reach_(static_cast<std::ptrdiff_t>(reach)), re_(2 * reach + 1), im_(2 * reach + 1) {
    std::vector<Complex> spectrum(transform.bins());
    transform.forward(record, spectrum);
    for (std::size_t k = 0; k <= reach; ++k) {
      const std::size_t bin = k < record.size() ? k : k - record.size();
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

  /// Covariance over a range of bins of root U, real parts first and then the imaginary ones, with
  /// zeros up to a multiple of four.
  [[nodiscard]] Eigen::MatrixXd covariance(const BinRange& range,
                                           const Eigen::VectorXd& root) const {
    const auto first = static_cast<std::ptrdiff_t>(range.first);
    const Eigen::Index bins = root.size();
    const Eigen::Index size = (2 * bins + 3) / 4 * 4;
    Eigen::MatrixXd out = Eigen::MatrixXd::Zero(size, size);
    const auto real = [&](Eigen::Index f) { return f; };
    const auto imaginary = [&](Eigen::Index f) { return bins + f; };
    // E U(f) U(g)*, as far apart in turn.
    for (Eigen::Index apart = 0; apart < bins; ++apart) {
      Complex sum = 0.0;
      for (Eigen::Index f = 0; f + apart < bins; ++f) {
        const Eigen::Index g = f + apart;
        sum = f > 0 ? next_alike(sum, first + f, first + g) : alike(first + f, first + g);
        const Complex half = root[f] * root[g] * less_mean(sum, first + f, first + g);
        out(real(f), real(g)) = out(imaginary(f), imaginary(g)) = half.real();
        out(real(f), imaginary(g)) = -half.imag();
        out(real(g), imaginary(f)) = half.imag();
      }
    }
    // E U(f) U(g), from where they are nearest to where they are farthest apart.
    for (Eigen::Index both = 0; both <= 2 * (bins - 1); ++both) {
      Eigen::Index f = both / 2;
      Eigen::Index g = both - f;
      Complex one = crossing(first + f, first + g);
      Complex other = f == g ? one : outwards(one, first + f, first + g);
      for (; f >= 0 && g < bins; --f, ++g) {
        const Complex half =
            root[f] * root[g] * (one + other - crossed_with_mean(first + f, first + g));
        out(real(f), real(g)) += half.real();
        out(imaginary(f), imaginary(g)) -= half.real();
        out(real(f), imaginary(g)) += half.imag();
        if (f != g) {
          out(real(g), imaginary(f)) += half.imag();
        }
        other = outwards(other, first + g, first + f);
        one = inwards(one, first + f - 1, first + g + 1);
      }
    }
    out.triangularView<Eigen::StrictlyLower>() = out.transpose();
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
  [[nodiscard]] Complex inwards(Complex after, std::ptrdiff_t f, std::ptrdiff_t g) const {
    return after - times(w_.at(f), w_.at(g)) + times(w_.at(f - judged_), w_.at(g + judged_));
  }
  /// Of (f + 1, g - 1), from that of (f, g).
  [[nodiscard]] Complex outwards(Complex before, std::ptrdiff_t f, std::ptrdiff_t g) const {
    return before + times(w_.at(f), w_.at(g)) - times(w_.at(f - judged_), w_.at(g + judged_));
  }
  [[nodiscard]] Complex crossed_with_mean(std::ptrdiff_t f, std::ptrdiff_t g) const {
    return times(shared_at(f), w_.at(g)) + times(w_.at(f), shared_at(g)) -
           2.0 * quiet_ * times(w_.at(f), w_.at(g));
  }

  std::ptrdiff_t judged_;
  Lines w_;
  std::vector<Complex> shared_;
  double quiet_ = 0.0;
};

/// Operations that a tile's exact moments may cost.
constexpr std::size_t kMostOperations = 1'000'000;

/// Of a symmetric matrix of whole fours of rows.
KOLSKY_WIDE double trace_of_cube(const Eigen::MatrixXd& matrix) {
  const auto column = [&](Eigen::Index k) {
    return reinterpret_cast<const Four*>(matrix.data() + k * matrix.rows());
  };
  Four trace{};
  for (Eigen::Index j = 0; j < matrix.cols(); j += 4) {
    for (Eigen::Index q = j / 4; q < matrix.rows() / 4; ++q) {
      Four square0{}, square1{}, square2{}, square3{};  // of four columns
      for (Eigen::Index k = 0; k < matrix.cols(); ++k) {
        const double* const others = &matrix(j, k);
        square0 += column(k)[q] * others[0];
        square1 += column(k)[q] * others[1];
        square2 += column(k)[q] * others[2];
        square3 += column(k)[q] * others[3];
      }
      const double times = 4 * q == j ? 1.0 : 2.0;  // above the diagonal too
      trace += times * (square0 * column(j)[q] + square1 * column(j + 1)[q] +
                        square2 * column(j + 2)[q] + square3 * column(j + 3)[q]);
    }
  }
  return trace[0] + trace[1] + trace[2] + trace[3];
}

TileNoise exact(const Eigen::MatrixXd& covariance) {
  return {covariance.trace(), covariance.squaredNorm(), trace_of_cube(covariance)};
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
    double before = 0.0;
    for (std::ptrdiff_t g = 0; g < f; ++g) {
      before += share[g] * (apart[static_cast<std::size_t>(f - g)] +
                            together[static_cast<std::size_t>(f + g)]);
    }
    const double itself = share[f] * (apart[0] + together[static_cast<std::size_t>(2 * f)]);
    noise.second += 2.0 * share[f] * (2.0 * before + itself);
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

TileNoise PlaceNoise::whole() const {
  if (rounded.empty()) {
    return normal;
  }
  const Eigen::Map<const Eigen::ArrayXd> energy(rounded.data(),
                                                static_cast<Eigen::Index>(rounded.size()));
  const double mean = energy.mean();
  const double variance = (energy - mean).square().mean();
  const double cubes = (energy - mean).cube().mean();
  // Noise of this power per component beside an energy R: variance 4 p R more, third moment 24 p^2
  // R.
  const double power = normal.mean > 0.0 ? normal.second / normal.mean : 0.0;
  TileNoise sum = normal;
  sum.mean += mean;
  sum.second += 2.0 * power * mean + 0.5 * variance;
  sum.third += 3.0 * power * power * mean + 1.5 * power * variance + 0.125 * cubes;
  sum.third = std::max(sum.third, sum.second * sum.second / sum.mean);
  return sum;
}

PlaceNoise& PlaceNoise::operator+=(const PlaceNoise& other) {
  normal += other.normal;
  rounded.resize(other.rounded.size(), 0.0);
  std::transform(rounded.begin(), rounded.end(), other.rounded.begin(), rounded.begin(),
                 std::plus<>());
  return *this;
}

TileNoise tile_noise_of(const Eigen::MatrixXd& draws) {
  const auto count = static_cast<double>(draws.cols());
  Eigen::MatrixXd products = draws.transpose() * draws;
  TileNoise noise{products.trace() / count, 0.0, 0.0};
  products.diagonal().setZero();
  const Eigen::MatrixXd twice = products * products;
  noise.second = products.squaredNorm() / (count * (count - 1.0));
  noise.third = twice.cwiseProduct(products).sum() / (count * (count - 1.0) * (count - 2.0));
  // What traces of a covariance of so many components cannot be less than.
  const auto most = static_cast<double>(draws.rows());
  noise.second = std::max(noise.second, noise.mean * noise.mean / most);
  noise.third = std::max(noise.third, noise.second * noise.second / noise.mean);
  return noise;
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
      list.push_back(exact(moments.covariance(range, root)));
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
