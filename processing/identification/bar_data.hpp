#pragma once

#include <Eigen/Core>
#include <cmath>
#include <optional>
#include <span>
#include <vector>

#include "processing/base/shot.hpp"
#include "processing/identification/bar_records.hpp"
#include "processing/identification/noise_spectrum.hpp"
#include "processing/identification/two_passes.hpp"
#include "processing/waves/transform.hpp"

namespace kolsky {

/// Noise of a bar's gauges as it weighs on what is judged.
struct BarNoise {
  std::vector<NoiseSpectrum> spectra;                     ///< by gauge
  std::vector<std::vector<double>> power;                 ///< by gauge and judged bin
  std::vector<std::vector<double>> variance_of_baseline;  ///< by gauge and shot

  /// The parts of a gauge's noise that are slower than a sample, in its samples.
  [[nodiscard]] const std::vector<NoiseSpectrum::SlowPart>& slow(std::size_t gauge) const {
    return spectra[gauge].slow_parts();
  }
  /// Standard deviation of a shot's baseline at a gauge.
  [[nodiscard]] double baseline_sd(std::size_t shot, std::size_t gauge) const {
    return std::sqrt(variance_of_baseline[gauge][shot]);
  }
};

/// Records of one bar's shots as a fit needs them: damped spectra, low-passed and cut off where the
/// low-pass has left nothing, and the way back to the part of the record that is judged.
///
/// A filter that is causal along the bar is applied to the damped spectra. What comes out is looked
/// at in time at a lower rate, its ends (where the low-pass smears the record's cut ends) are left
/// away, and the rest goes to the imaginary axis: so a record that ends while waves ring costs
/// nothing. Offsets live in the bin at zero, which is left out.
class BarData {
 public:
  using Spectrum = std::vector<Complex>;

  /// @param first  of a bar with one gauge (see split_passes)
  /// @param band_limit_Hz  0: where the pulses fall below the noise, at most where waves of the
  ///   first mode end to be all there is
  /// @throws InputError where the shots are of different benches or cannot serve (see
  ///   read_bar_records, split_passes)
  BarData(const std::vector<Shot>& shots, double band_limit_Hz, const FirstPass& first = {});

  [[nodiscard]] const Bench& bench() const { return bench_; }
  [[nodiscard]] const std::vector<BarRecords>& records() const { return records_; }
  [[nodiscard]] std::size_t shots() const { return records_.size(); }
  [[nodiscard]] std::size_t gauges() const { return records_.front().position_m.size(); }
  /// Whether one gauge stands for two (see split_passes).
  [[nodiscard]] bool two_passes() const { return records_.front().returned; }
  [[nodiscard]] double band_limit_Hz() const { return band_limit_Hz_; }
  /// What is judged of each record, from the first judged sample to the last.
  [[nodiscard]] double judged_s() const {
    return static_cast<double>(places_.judged()) * places_.period_s;
  }

  /// Where the damped spectra are, and those on the imaginary axis.
  [[nodiscard]] const std::vector<Complex>& path() const { return path_; }
  [[nodiscard]] const std::vector<Complex>& judged_path() const { return judged_path_; }

  [[nodiscard]] const Spectrum& spectrum(std::size_t shot, std::size_t gauge) const {
    return spectra_[shot][gauge];
  }
  /// Stands for a shot: the sum of all, weighted (by squares that add up to 1, so that its noise is
  /// a shot's) to hold what they have in common.
  [[nodiscard]] std::size_t all_as_one() const { return shots(); }
  /// How many such sums, `all_as_one` and those after it, at right angles to each other, hold more
  /// of the pulses than of noise. The others say nothing of the bar.
  [[nodiscard]] std::size_t telling() const { return spectra_.size() - shots(); }
  /// The same of a record that is 1 throughout.
  [[nodiscard]] const Spectrum& unit_offset() const { return unit_offset_; }
  /// The same of a record that is 1 in its first sample and 0 after it.
  [[nodiscard]] const Spectrum& unit_impulse() const { return unit_impulse_; }
  /// Places at the lower rate: where records begin, are no longer quiet and end, and
  /// what is judged of them.
  struct Places {
    std::size_t samples = 0;  ///< of the transform at that rate
    double period_s = 0.0;
    double records_begin = 0.0;
    double quiet_end = 0.0;
    double records_end = 0.0;
    std::size_t judged_begin = 0;
    std::size_t judged_end = 0;
    double samples_per_place = 1.0;  ///< of the records
    [[nodiscard]] std::size_t judged() const { return judged_end - judged_begin; }
  };
  [[nodiscard]] const Places& places() const { return places_; }
  [[nodiscard]] const Spectrum& judged(std::size_t shot, std::size_t gauge) const {
    return judged_[shot][gauge];
  }
  /// A shot's spectra by gauge, the damped ones and those that are judged.
  struct Spectra {
    std::vector<Spectrum> damped;
    std::vector<Spectrum> judged;
  };
  /// Of records that hold noise alone, their baselines taken off as a shot's are. The same at every
  /// call.
  [[nodiscard]] std::vector<Spectra> noise_alone(const BarNoise& noise, std::size_t count) const;
  /// What judging multiplies a bin of the transform by.
  [[nodiscard]] double undo_filter(std::size_t bin) const { return undo_filter_[bin]; }
  /// Each gauge's noise by the quiet part of all shots together; never less than that of its codes.
  [[nodiscard]] const BarNoise& noise() const { return noise_; }
  /// The same, by what else there is to see of it, gauges that are alike taken together.
  /// @param seen  by gauge
  [[nodiscard]] BarNoise noise_with(const std::vector<NoiseSpectrum::Seen>& seen) const;
  /// Power per sample of a gauge's noise below which it cannot be: that of its codes.
  [[nodiscard]] double least_noise(std::size_t gauge) const;
  /// Power in a judged bin of noise of unit power per sample.
  [[nodiscard]] double power_of_unit() const {
    return static_cast<double>(places_.judged()) / places_.samples_per_place;
  }

 private:
  void choose_band(double asked_Hz);
  void choose_judged_part();
  void choose_judged_bins();
  [[nodiscard]] double quiet_to_skip(double edge) const;
  [[nodiscard]] std::vector<std::span<const double>> quiet_of(std::size_t gauge) const;
  /// Fills in the powers and baselines that follow from the spectra.
  void weigh(BarNoise& noise) const;
  void prepare_spectra();
  void combine_shots();
  void combine(const Eigen::VectorXd& weights);

  Bench bench_;
  std::vector<BarRecords> records_;
  std::size_t lead_;  ///< zeros before and after each record
  DampedTransform transform_;
  double band_limit_Hz_ = 0.0;
  double filter_limit_Hz_ = 0.0;
  Places places_;
  std::vector<Complex> path_;
  std::vector<Complex> judged_path_;
  std::vector<double> undo_filter_;
  std::vector<std::vector<Spectrum>> spectra_;  ///< by shot, that of all as one last, and gauge
  std::vector<std::vector<Spectrum>> judged_;   ///< likewise
  Spectrum unit_offset_;
  Spectrum unit_impulse_;
  BarNoise noise_;
};

}  // namespace kolsky
