#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "processing/identification/noise_spectrum.hpp"
#include "processing/specimen/shpb_model.hpp"
#include "processing/waves/transform.hpp"

namespace kolsky {

/// Which part of the records is judged.
struct SpecimenWindow {
  double band_limit_Hz = 0.0;  ///< 0: where the pulses fall below the noise
  /// From the first quiet sample to so long after the pulse's foot at the first station; 0: to the
  /// record's end.
  double after_foot_s = 0.0;
};

/// How likely the gauge records of a specimen's shots are, given its compliance and the known
/// unknowns of its bench.
///
/// Each shot's source is eliminated exactly by the station nearest to the impact (see ShpbModel):
///     r_j(t) = y_j - (H_j / H_0) y_0,      j = 1 .. stations - 1,
/// causal, computed on a damped line, so that a window that ends while waves ring costs nothing;
/// under the model r is noise alone. It is judged at the plain Fourier frequencies of the window.
/// Its covariance there is that of noise through exactly this operation: H_j / H_0 rings for a
/// soft specimen and elastic bars, and the noise of the quiet samples is in the baseline. Slow
/// noise hangs together over the record: its parts go through the operation as they are, what is
/// left of each frequency's power as if it were white.
///
/// Holds work space: one thread at a time.
class SpecimenLikelihood {
 public:
  /// @throws InputError as read_shpb_records, and where the window holds too little
  SpecimenLikelihood(const std::vector<Shot>& shots, const BarPrior& bars,
                     const SpecimenWindow& window);

  /// Residuals, `shots() x residuals_per_shot()`, real and imaginary parts beside each other.
  /// @param moves  of the known unknowns, in their standard deviations
  void residuals(const ShpbTheory& theory, const Compliance& specimen,
                 std::span<const double> moves, Eigen::MatrixXd& out);

  /// Lower Cholesky factor of the covariance of one shot's residuals.
  [[nodiscard]] Eigen::MatrixXd covariance_root(const ShpbTheory& theory,
                                                const Compliance& specimen,
                                                std::span<const double> moves);

  /// One shot's relative correction of the specimen's compliance at one frequency.
  struct ComplianceStep {
    double frequency_Hz = 0.0;
    Complex relative;       ///< J is (1 + relative) times what was assumed
    double noise_sd = 0.0;  ///< of its real and of its imaginary part, from the gauges' noise
  };

  /// What the residuals of each shot say of the compliance frequency by frequency, to first order
  /// about the one assumed: correction by shot and frequency. On a damped line again, so that the
  /// window's end leaks nothing, over all stations by their noise.
  [[nodiscard]] std::vector<std::vector<ComplianceStep>> compliance_steps(
      const ShpbTheory& theory, const Compliance& specimen, std::span<const double> moves);

  /// The first arrival, after the pulse's foot at the first station, of anything that a far end
  /// has sent back to the specimen, at the station that sees it first: until then no face can have
  /// parted.
  [[nodiscard]] double first_return_s() const { return first_return_s_; }

  [[nodiscard]] std::size_t shots() const { return records_.size(); }
  [[nodiscard]] std::size_t residuals_per_shot() const {
    return 2 * bins_ * (stations_.size() - 1);
  }
  [[nodiscard]] const std::vector<ShpbUnknown>& unknowns() const { return unknowns_; }
  [[nodiscard]] const std::vector<ShpbStation>& stations() const { return stations_; }
  [[nodiscard]] const std::vector<ShpbRecords>& records() const { return records_; }
  [[nodiscard]] const Bench& bench() const { return bench_; }
  [[nodiscard]] const BarPrior& bars() const { return bars_; }
  [[nodiscard]] double band_limit_Hz() const { return band_limit_Hz_; }
  /// As asked for in the window.
  [[nodiscard]] double after_foot_s() const { return after_foot_s_; }
  [[nodiscard]] double judged_s() const { return static_cast<double>(judged_) * period_s_; }
  [[nodiscard]] double period_s() const { return period_s_; }
  /// Power of a station's noise per sample at the judged frequencies.
  [[nodiscard]] const std::vector<double>& noise(std::size_t station) const {
    return noise_[station];
  }

 private:
  using Spectrum = std::vector<Complex>;

  /// The judged samples of what an operator makes of a shot's first station, plus its own record.
  void judged_part(const Spectrum& of_first, const Spectrum* own, const Spectrum& first);
  void find_first_return();
  void choose_band(double asked_Hz);
  void choose_judged();
  void prepare_spectra();
  void prepare_noise();
  [[nodiscard]] Eigen::MatrixXd noise_response(const Spectrum& transfer);
  [[nodiscard]] std::size_t noise_group() const;
  [[nodiscard]] Eigen::MatrixXd of_own_noise(std::size_t station) const;
  void add_first_stations_noise(const Eigen::MatrixXd& response, Eigen::MatrixXd& covariance) const;

  Bench bench_;
  BarPrior bars_;
  std::vector<ShpbStation> stations_;
  std::vector<ShpbRecords> records_;
  std::vector<ShpbUnknown> unknowns_;
  double period_s_;
  double after_foot_s_;
  double first_return_s_ = 0.0;
  double band_limit_Hz_ = 0.0;
  double filter_limit_Hz_ = 0.0;
  std::size_t lead_ = 0;    ///< zeros before each record: the filter reaches to both sides
  std::size_t begin_ = 0;   ///< first judged sample of the records
  std::size_t judged_ = 0;  ///< samples
  std::size_t bins_ = 0;    ///< judged frequencies, from the first above zero
  std::optional<DampedTransform> transform_;
  std::optional<DampedTransform> plain_;     ///< of what is judged, on the imaginary axis
  std::vector<Complex> path_;                ///< damped, as far as the filter leaves anything
  std::vector<Complex> filter_damped_;       ///< on `path_`
  std::vector<double> filter_;               ///< at the judged frequencies
  std::vector<std::vector<double>> noise_;   ///< by station and judged frequency, per sample
  std::vector<std::vector<double>> steady_;  ///< what of it is not in the slow parts
  std::vector<std::vector<NoiseSpectrum::SlowPart>> slow_;  ///< by station
  std::vector<Eigen::MatrixXd> own_noise_;      ///< by other station: covariance of its residuals
  std::vector<std::vector<Spectrum>> spectra_;  ///< filtered, by shot and station
  ShpbModel model_;
  std::vector<Spectrum> transfers_;
  Spectrum work_spectrum_;
  Spectrum plain_spectrum_;
  std::vector<double> work_;
};

}  // namespace kolsky
