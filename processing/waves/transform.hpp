#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "processing/waves/compliance.hpp"

namespace kolsky {

/// The next length, at least so many samples, that is even and has small prime factors.
[[nodiscard]] std::size_t good_transform_length(std::size_t samples);

/// One up to a tenth above these samples that holds two most often: estimated plans take 4608
/// samples in four fifths of the time that 4320 take. For transforms whose length is free.
[[nodiscard]] std::size_t quick_transform_length(std::size_t samples);

/// Laplace transform of sampled records along the line s = eta + i w, by FFT of the record times
/// exp(-eta t). Against the Fourier transform it has two virtues for bars: whatever a causal
/// operation pushes past the end of the record comes back at its start damped by exp(-eta T)
/// instead of whole, and a record that is cut while waves still ring leaks nothing into what was
/// before the cut. Nothing is singular at w = 0 either.
///
/// Plans and tables are made once, with FFTW_ESTIMATE: measured plans differ in their last bits
/// from run to run. Holds its own work space: one thread at a time.
class DampedTransform {
 public:
  /// @param samples   longest record; transforms are of the next length with small prime factors
  /// @param period_s  time from sample to sample
  /// @param wrap_damping  exp(-eta T) over the transform's length T
  DampedTransform(std::size_t samples, double period_s, double wrap_damping = 1e-8);
  /// Undamped, of a window whose length is given by what it holds.
  /// @pre samples is even
  [[nodiscard]] static DampedTransform of_window(std::size_t samples, double period_s);
  ~DampedTransform();
  DampedTransform(DampedTransform&&) noexcept;
  DampedTransform& operator=(DampedTransform&&) noexcept;

  [[nodiscard]] std::size_t length() const;  ///< samples of the transform, >= the record's
  [[nodiscard]] std::size_t bins() const;    ///< length / 2 + 1
  [[nodiscard]] double bin_width_Hz() const;
  [[nodiscard]] Complex s(std::size_t bin) const;  ///< eta + 2 pi i bin / T

  /// spectrum[k] = sum_n record[n] exp(-s_k t_n), without the factor dt; fills as many bins as are
  /// asked for. A shorter record counts as zero beyond its end. @pre spectrum.size() <= bins()
  void forward(std::span<const double> record, std::span<Complex> spectrum);

  /// The inverse; fills as much of the record as is asked for, from sample `first` on. A shorter
  /// spectrum counts as zero beyond its end.
  /// @pre spectrum.size() <= bins(), first + record.size() <= length()
  void inverse(std::span<const Complex> spectrum, std::span<double> record, std::size_t first = 0);

 private:
  struct State;
  explicit DampedTransform(std::unique_ptr<State> state);

  std::unique_ptr<State> state_;
};

}  // namespace kolsky
