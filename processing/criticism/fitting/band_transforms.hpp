#pragma once

#include <span>
#include <vector>

#include "processing/criticism/records/judged_band.hpp"
#include "processing/waves/transform.hpp"

namespace kolsky {

/// The way of records to where waves are carried and of residuals to where they are judged:
///     record, at its own rate  -> carried bins, along a damped path, filtered beyond the band
///     carried bins             -> judged window, at the decimated rate
///     judged window            -> judged bins, undamped, the filter taken out again
///
/// Holds its own work space: one thread at a time.
class BandTransforms {
 public:
  using Spectrum = std::vector<Complex>;

  BandTransforms(const JudgedBand& band, double period_s);

  /// s at the carried bins [1/s].
  [[nodiscard]] const Spectrum& path() const { return path_; }
  /// What the filter passes at these bins.
  [[nodiscard]] const Spectrum& filter() const { return filter_; }
  /// The same at a judged bin.
  [[nodiscard]] double passes(std::size_t judged_bin) const { return judged_filter_[judged_bin]; }
  /// Between carried bins and the decimated rate.
  [[nodiscard]] DampedTransform& decimated() { return decimated_; }
  /// Of the judged window's transform, from frequency zero on.
  [[nodiscard]] std::size_t window_bins() const { return window_.bins(); }

  /// A record's spectrum at the carried bins, filtered.
  void carry(std::span<const double> record, Spectrum& out);
  /// Takes off a record what lies beyond the judged band: noise alone, by what a band is judged
  /// for.
  void smooth(std::vector<double>& record);
  /// @param carried  filtered
  /// @return over the judged window; until the next call
  [[nodiscard]] std::span<const double> window_of(const Spectrum& carried);
  /// The judged bins of that window. @param carried  filtered
  void judge(const Spectrum& carried, Spectrum& out);
  /// The judged window without what is beyond the judged bins. @param carried  filtered
  [[nodiscard]] std::vector<double> judged_record(const Spectrum& carried);
  /// @param spectrum  of the judged window, from frequency zero on
  [[nodiscard]] std::vector<double> window_with(const Spectrum& spectrum);
  /// The same window at the records' rate; until the next call.
  [[nodiscard]] std::span<const double> fine_window_with(const Spectrum& spectrum);
  /// How the judged window answers to single samples of a record that a transfer carries, from lag
  /// -before on at the decimated rate (`CarriedNoise::through`). @param transfer  at carried bins
  void respond(const Spectrum& transfer, std::vector<double>& response);

 private:
  void transform(std::span<const double> record);
  void judge(std::span<const double> window, Spectrum& out);

  JudgedBand band_;
  double judged_period_s_;
  DampedTransform whole_;      ///< of records, at their rate
  DampedTransform decimated_;  ///< the same bins, for residuals
  DampedTransform window_;     ///< of the judged window
  DampedTransform fine_;       ///< the same window at the records' rate
  Spectrum path_;
  Spectrum filter_;
  /// The filter so much later that what it smears before a response's first sample is there too.
  Spectrum filter_of_response_;
  std::vector<double> judged_filter_;
  std::vector<double> record_;
  std::vector<double> residual_;
  std::vector<double> fine_record_;
  Spectrum full_;
  Spectrum carried_;
  Spectrum judged_;
};

}  // namespace kolsky
