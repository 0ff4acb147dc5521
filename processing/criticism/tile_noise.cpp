#include "processing/criticism/tile_noise.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "processing/criticism/statistics.hpp"
#include "processing/waves/transform.hpp"

namespace kolsky {

namespace {

/// A real record's transform, looked up at any whole frequency.
class Lines {
 public:
  explicit Lines(std::span<const double> record) : length_(record.size()) {
    DampedTransform transform(length_, 1.0, 1.0);
    lines_.resize(transform.bins());
    transform.forward(record, lines_);
  }

  [[nodiscard]] Complex at(std::size_t frequency) const {
    const std::size_t folded = frequency % length_;
    return folded < lines_.size() ? lines_[folded] : std::conj(lines_[length_ - folded]);
  }
  [[nodiscard]] Complex minus(std::size_t a, std::size_t b) const { return at(a + length_ - b); }

 private:
  std::size_t length_;
  std::vector<Complex> lines_;
};

/// Operations that a tile's exact moments may cost.
constexpr std::size_t kMostOperations = 1'000'000;

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

std::vector<TileNoise> tile_noise(std::span<const double> window, std::span<const double> quiet,
                                  std::size_t judged, std::span<const BinRange> ranges) {
  std::vector<double> square(window.begin(), window.end());
  for (double& value : square) {
    value *= value;
  }
  const std::vector<double> none(window.size(), 0.0);
  const Lines w(window);
  const Lines w2(square);
  const Lines v(quiet.empty() ? std::span<const double>(none) : quiet);
  const double n = static_cast<double>(window.size());
  const auto share = [&](std::size_t bin) {
    return bin == 0 || 2 * bin == window.size() ? 0.5 : 1.0;
  };
  std::vector<TileNoise> list;
  for (const BinRange& range : ranges) {
    const std::size_t bins = range.end - range.first;
    // From real and imaginary parts of the judged bins to those of the tile's.
    Eigen::MatrixXd map(2 * bins, 2 * judged);
    for (std::size_t f = range.first; f < range.end; ++f) {
      const auto row = static_cast<Eigen::Index>(2 * (f - range.first));
      const double root = std::sqrt(share(f)) / n;
      for (std::size_t k = 1; k <= judged; ++k) {
        const auto column = static_cast<Eigen::Index>(2 * (k - 1));
        const Complex below = w.minus(f, k);
        const Complex above = w.at(f + k);
        const Complex of_real = root * (below + above - 2.0 * v.at(k).real() * w.at(f));
        const Complex of_imaginary =
            root * (Complex(0.0, 1.0) * (below - above) - 2.0 * v.at(k).imag() * w.at(f));
        map(row, column) = of_real.real();
        map(row + 1, column) = of_real.imag();
        map(row, column + 1) = of_imaginary.real();
        map(row + 1, column + 1) = of_imaginary.imag();
      }
    }
    TileNoise noise;
    noise.mean = map.squaredNorm();
    if (4 * bins * bins * 2 * judged <= kMostOperations) {
      const Eigen::MatrixXd covariance = map * map.transpose();
      noise.second = covariance.squaredNorm();
      noise.third = (covariance * covariance).cwiseProduct(covariance).sum();
    } else {
      for (std::size_t f = range.first; f < std::min(range.end, judged + 1); ++f) {
        for (std::size_t g = range.first; g < std::min(range.end, judged + 1); ++g) {
          noise.second += share(f) * share(g) * 2.0 / (n * n) *
                          (std::norm(w2.minus(f, g)) + std::norm(w2.at(f + g)));
        }
      }
      noise.third = noise.second * noise.second / noise.mean;
    }
    list.push_back(noise);
  }
  return list;
}

}  // namespace kolsky
