#pragma once

#include <optional>
#include <span>
#include <vector>

#include "processing/base/shot.hpp"
#include "processing/identification/bar_records.hpp"
#include "processing/identification/known_unknowns.hpp"
#include "processing/waves/bar_modes.hpp"
#include "processing/waves/transform.hpp"

namespace kolsky {

/// How likely the gauge records of a bar's shots are, given its compliance and the known unknowns
/// of its bench.
///
/// Each shot's source, the right-going wave at the impacted end, is free at all times, so nothing
/// is assumed of the striker or of what that end does; the far end is free. With h_j = a_j
/// (exp(-gamma x_j) - exp(-gamma (2 L - x_j))), a_j the gauge's gain, the source is eliminated
/// exactly,
///     r_j(t) = y_j - (h_j / h_0) y_0,      j = 1 .. gauges - 1,
/// which is causal, so that a record that ends while waves ring costs nothing, and under the model
/// is noise alone. Its covariance at each frequency, diag(p_j) + p_0 g g^H with g_j = h_j / h_0 and
/// p the noise's power, follows the parameters: the whitened sum of squares is then that with the
/// source at its own best fit.
///
/// Holds work space: one thread at a time.
class BarLikelihood {
 public:
  /// @param band_limit_Hz  0: where the pulses fall below the noise, at most where surface gauges
  /// go blind
  /// @throws InputError where the shots are of different benches or cannot serve (see
  /// read_bar_records)
  BarLikelihood(const std::vector<Shot>& shots, WaveTheory theory, double band_limit_Hz);

  /// Whitened residuals, of unit variance each under the model.
  /// @param moves  of the known unknowns, in their standard deviations
  /// @param out    `residuals()` of them
  void evaluate(const Compliance& compliance, std::span<const double> moves, std::span<double> out);

  [[nodiscard]] std::size_t residuals() const;
  [[nodiscard]] const std::vector<KnownUnknown>& unknowns() const { return unknowns_; }
  [[nodiscard]] const Bench& bench() const { return bench_; }
  [[nodiscard]] const std::vector<BarRecords>& records() const { return records_; }
  [[nodiscard]] double band_limit_Hz() const { return band_limit_Hz_; }

 private:
  using Spectrum = std::vector<Complex>;

  [[nodiscard]] std::size_t gauges() const { return records_.front().position_m.size(); }
  void choose_band(double asked_Hz);
  void prepare_noise();
  void prepare_spectra();
  /// h_j / h_0 for j = 1 .. gauges - 1 at the first `count` places of a path.
  [[nodiscard]] std::vector<Spectrum> transfers(const MovedBench& moved,
                                                const Compliance& compliance,
                                                const std::vector<Complex>& path,
                                                std::size_t count) const;
  void residual_spectrum(std::size_t shot, std::size_t gauge, const Spectrum& transfer,
                         Spectrum& out);
  double* whiten(const std::vector<Spectrum>& residual, const std::vector<Spectrum>& transfer,
                 double* out) const;

  WaveTheory theory_;
  Bench bench_;
  std::vector<BarRecords> records_;
  std::vector<KnownUnknown> unknowns_;
  std::size_t lead_;
  DampedTransform transform_;
  std::optional<DampedTransform> plain_;  ///< of what is judged, on the imaginary axis
  std::vector<Complex> damped_path_;
  std::vector<Complex> plain_path_;  ///< from the first bin above zero, where offsets live
  double band_limit_Hz_ = 0.0;
  double filter_limit_Hz_ = 0.0;
  std::size_t edge_ = 0;  ///< samples at either end that are not judged
  std::size_t judged_ = 0;
  std::size_t bins_judged_ = 0;   ///< of the plain transform
  std::size_t bins_carried_ = 0;  ///< of the damped one; beyond, the filter has left nothing
  std::vector<double> filter_;    ///< on the plain path
  std::vector<std::vector<double>> noise_;      ///< power per bin, by gauge
  std::vector<std::vector<Spectrum>> spectra_;  ///< damped and filtered, by shot and gauge
  std::vector<double> work_;
  Spectrum plain_spectrum_;
};

}  // namespace kolsky
