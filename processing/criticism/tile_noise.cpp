#include "processing/criticism/tile_noise.hpp"

#include <algorithm>

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

}  // namespace

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
  const double unit = 2.0 / (n * n);
  double mean_power = 0.0;
  for (std::size_t k = 1; k <= judged; ++k) {
    mean_power += 2.0 * unit * std::norm(v.at(k));
  }
  const auto share = [&](std::size_t bin) {
    return bin == 0 || 2 * bin == window.size() ? 0.5 : 1.0;
  };
  std::vector<TileNoise> list;
  for (const BinRange& range : ranges) {
    TileNoise noise;
    double variance = 0.0;
    double of_mean = 0.0;
    for (std::size_t f = range.first; f < range.end; ++f) {
      double power = 0.0;
      Complex with_mean = 0.0;
      for (std::size_t k = 1; k <= judged; ++k) {
        const Complex below = w.minus(f, k);
        const Complex above = w.at(f + k);
        power += unit * (std::norm(below) + std::norm(above));
        with_mean += unit * (below * v.at(k) + above * std::conj(v.at(k)));
      }
      const double shifted = std::norm(w.at(f)) * mean_power;
      of_mean += share(f) * shifted;
      noise.mean += share(f) * (power + shifted - 2.0 * (std::conj(w.at(f)) * with_mean).real());
      for (std::size_t g = range.first; g < range.end; ++g) {
        variance += share(f) * share(g) * 4.0 / (n * n) *
                    (std::norm(w2.minus(f, g)) + std::norm(w2.at(f + g)));
      }
    }
    variance += 2.0 * of_mean * of_mean;
    noise.freedom = variance > 0.0 ? 2.0 * noise.mean * noise.mean / variance : 0.0;
    list.push_back(noise);
  }
  return list;
}

}  // namespace kolsky
