#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace kolsky {

/// A straight line through quiet samples.
struct BaselineLine {
  double value_codes = 0.0;  ///< at the reference sample
  double slope_codes = 0.0;  ///< per sample
};

/// What a stretch of quiet samples says about the baseline and the noise.
struct QuietEstimate {
  BaselineLine line;               ///< reference: the sample after the last
  double noise_variance = 0.0;     ///< of one sample about the line, codes²
  double baseline_variance = 0.0;  ///< of the line half a stretch further on, codes²
};

/// Line and noise of a stretch, by the medians of eight equal groups: a spike, or anything else
/// that fills less than three groups, hardly moves it. @pre at least 16 samples
[[nodiscard]] QuietEstimate estimate_quiet(std::span<const double> samples);

/// How the baseline is followed, in samples; see TriggerOptions.
struct BaselineMemory {
  std::size_t baseline_samples = 256;
  std::size_t noise_samples = 20000;
  std::size_t guard_samples = 40;
};

/// Follows level and slope of the baseline and the mean square about its prediction, in cells of
/// fixed size: a fading-memory line fit (Morrison 1969: gains 1 - t² and (1 - t)²) that begins as
/// an ordinary fit to all there is. Cells are held back for the guard time, so that the foot of a
/// pulse that is about to be found is not in the baseline it is measured from.
class BaselineTracker {
 public:
  static constexpr std::size_t kCell = 128;  ///< samples

  explicit BaselineTracker(const BaselineMemory& memory);

  /// Begins from a stretch of `samples` quiet samples that ends where the next cell begins.
  /// The mean square about the line is kept if it was known, unless the new one is much greater.
  void start(const QuietEstimate& quiet, std::size_t samples);
  void forget();

  /// The line over the next cell; reference: its first sample.
  [[nodiscard]] BaselineLine next_cell() const noexcept;
  /// The next cell is over: mean of its quiet samples and their variance about that mean.
  void take(double mean_codes, double variance_codes2) noexcept;
  /// The next cell is over and had too few quiet samples.
  void skip() noexcept;

  /// Mean square of a sample about the predicted line, codes².
  [[nodiscard]] double noise_variance() const noexcept { return noise_variance_; }
  /// Variance of `noise_variance` over its square.
  [[nodiscard]] double noise_relative_variance() const noexcept { return 2.0 * noise_spread_; }
  /// Of the predicted line, codes².
  [[nodiscard]] double baseline_variance() const noexcept { return baseline_variance_; }
  [[nodiscard]] bool known() const noexcept { return noise_spread_ > 0.0; }

 private:
  struct Cell {
    bool quiet = false;
    double mean = 0.0;
    double mean_square = 0.0;  ///< of a sample about the prediction
    double miss_square = 0.0;  ///< of the mean about the prediction
  };
  struct Squares {
    double cells = 0.0;
    double mean_square = 0.0;
    double miss_square = 0.0;
  };
  void push(const Cell& cell) noexcept;
  void absorb(const Cell& cell) noexcept;
  void absorb_noise(const Cell& cell) noexcept;

  double level_gain_;  ///< least gains of the line, per cell
  double slope_gain_;
  double noise_gain_;        ///< least gain of the mean squares, per cell
  std::vector<Cell> guard_;  ///< a ring, when the guard is longer than a cell
  std::size_t guard_start_ = 0;
  std::size_t guard_size_ = 0;

  double level_ = 0.0;  ///< of the line at the middle of the last absorbed cell
  double slope_ = 0.0;  ///< per cell
  double cells_ = 0.0;  ///< the line rests on
  Squares waiting_;     ///< sums of cells whose squares are not yet in the noise
  double noise_cells_ = 0.0;
  double noise_variance_ = 0.0;
  double noise_spread_ = 0.0;  ///< one over the independent samples that the noise rests on
  double baseline_variance_ = 0.0;
};

}  // namespace kolsky
