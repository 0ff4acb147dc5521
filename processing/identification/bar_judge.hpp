#pragma once

#include <span>
#include <vector>

#include "processing/identification/bar_data.hpp"

namespace kolsky {

/// Takes damped spectra of a bar's records to time, and to what is judged of them (see BarData).
///
/// Holds work space: one thread at a time.
class BarJudge {
 public:
  /// @param data outlives this
  explicit BarJudge(const BarData& data);

  /// A damped spectrum in time, at the lower rate, from the first sample before which it is zero.
  [[nodiscard]] std::span<const double> in_time(std::span<const Complex> damped);
  /// Its judged part, on the imaginary axis, the low-pass undone.
  void judge(std::span<const Complex> damped, std::span<Complex> judged);
  /// The same of the product of two.
  void judge_product(std::span<const Complex> a, std::span<const Complex> b,
                     std::span<Complex> judged);

 private:
  [[nodiscard]] std::size_t carried() const;
  [[nodiscard]] std::span<const double> slow_in_time();
  void judge(std::span<const double> in_time, std::span<Complex> judged);

  const BarData& data_;
  DampedTransform slow_;   ///< the records' stretch of time at the lower rate
  DampedTransform plain_;  ///< of what is judged, undamped
  BarData::Spectrum slow_spectrum_;
  BarData::Spectrum plain_spectrum_;
  std::vector<double> slow_record_;
};

}  // namespace kolsky
