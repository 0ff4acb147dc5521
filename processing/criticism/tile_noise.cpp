#include "processing/criticism/tile_noise.hpp"

#include <algorithm>

#include "processing/waves/transform.hpp"

namespace kolsky {

namespace {

/// Squared magnitudes of a real record's transform, looked up at any whole frequency.
class Powers {
 public:
  explicit Powers(std::span<const double> record) : length_(record.size()) {
    DampedTransform transform(length_, 1.0, 1.0);
    std::vector<Complex> spectrum(transform.bins());
    transform.forward(record, spectrum);
    for (const Complex& value : spectrum) {
      powers_.push_back(std::norm(value));
    }
  }

  [[nodiscard]] double at(std::size_t frequency) const {
    const std::size_t folded = frequency % length_;
    return powers_[std::min(folded, length_ - folded)];
  }
  [[nodiscard]] double between(std::size_t a, std::size_t b) const {
    return at(a > b ? a - b : b - a);
  }

 private:
  std::size_t length_;
  std::vector<double> powers_;
};

}  // namespace

std::vector<TileNoise> tile_noise(std::span<const double> window, std::size_t judged,
                                  std::span<const BinRange> ranges) {
  std::vector<double> square(window.begin(), window.end());
  for (double& value : square) {
    value *= value;
  }
  const Powers of_window(window);
  const Powers of_square(square);
  const double n = static_cast<double>(window.size());
  const auto share = [&](std::size_t bin) {
    return bin == 0 || 2 * bin == window.size() ? 0.5 : 1.0;
  };
  std::vector<TileNoise> list;
  for (const BinRange& range : ranges) {
    TileNoise noise;
    double variance = 0.0;
    for (std::size_t f = range.first; f < range.end; ++f) {
      for (std::size_t k = 1; k <= judged; ++k) {
        noise.mean += share(f) * 2.0 / (n * n) * (of_window.between(f, k) + of_window.at(f + k));
      }
      for (std::size_t g = range.first; g < range.end; ++g) {
        variance +=
            share(f) * share(g) * 4.0 / (n * n) * (of_square.between(f, g) + of_square.at(f + g));
      }
    }
    noise.freedom = variance > 0.0 ? 2.0 * noise.mean * noise.mean / variance : 0.0;
    list.push_back(noise);
  }
  return list;
}

}  // namespace kolsky
